// meshopt.mjs MODULE IN.obj TOLERANCE OUT.obj: meshoptimizer's simplification to an absolute error, input units.
import {readFileSync, writeFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const [module, input, tolerance, output] = process.argv.slice(2);
const {MeshoptSimplifier} = await import(pathToFileURL(module));
await MeshoptSimplifier.ready;

const positions = [], indices = [];
for (const line of readFileSync(input, 'utf8').split('\n')) {
  const words = line.split(' ');
  if (words[0] === 'v') positions.push(...words.slice(1, 4).map(Number));
  if (words[0] === 'f') indices.push(...words.slice(1, 4).map((word) => parseInt(word, 10) - 1));
}
const [left] = MeshoptSimplifier.simplify(
    new Uint32Array(indices), new Float32Array(positions), 3, 0, Number(tolerance), ['ErrorAbsolute']);
const lines = [];
for (let k = 0; k < positions.length; k += 3) lines.push(`v ${positions[k]} ${positions[k + 1]} ${positions[k + 2]}`);
for (let k = 0; k < left.length; k += 3) lines.push(`f ${left[k] + 1} ${left[k + 1] + 1} ${left[k + 2] + 1}`);
writeFileSync(output, lines.join('\n') + '\n');
