// The engine of the browser gives the same mesh, byte for byte, as the program: node bytes.mjs PROGRAM ENGINE FOLDER,
// where ENGINE is soapfilm.js of web/CMakeLists.txt.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {basename, join, resolve} from 'node:path';
import {engine} from '../src/engine.js';

const [program, script, out] = process.argv.slice(2).map((path) => resolve(path));
mkdirSync(out, {recursive: true});
const create = createRequire(script)(script);
const run = (...args) => execFileSync(program, [...args, '--quiet'], {stdio: ['ignore', 'ignore', 'inherit']});

/** A PLY without the comments of its head: the program says there how it was called. */
function withoutComments(bytes) {
  const text = bytes.toString('latin1');
  const end = text.indexOf('end_header\n');
  return text.slice(0, end).replace(/^comment.*\n/gm, '') + text.slice(end);
}

async function inBrowser(file, parameters) {
  const events = [];
  const soapfilm = await engine(create, (kind, fraction, text) => events.push([kind, fraction, text]));
  soapfilm.put(basename(file), readFileSync(file));
  soapfilm.read(basename(file));
  soapfilm.reconstruct(parameters);
  const proves = !parameters.solve?.method; // the default does
  if (proves)
    assert.ok(
      events.some(([, , text]) => /gap/.test(text)),
      'no gap was told',
    );
  assert.equal(JSON.parse(soapfilm.report()).mesh.triangles, soapfilm.mesh([0, 0, 0]).indices.length / 3);
  return Buffer.from(soapfilm.write('mesh.ply'));
}

run('scan', 'knot', '-o', join(out, 'knot'), '--samples', '20000', '--noise', '0.3%', '--seed', '5');
const scans = join(out, 'knot/samples.ply');
const text = join(out, 'cloud.xyz');
writeFileSync(
  text,
  Array.from({length: 3000}, (_, i) => {
    const z = 1 - (2 * i + 1) / 3000,
      r = Math.sqrt(1 - z * z),
      a = 2.399963 * i;
    return [r * Math.cos(a), r * Math.sin(a) * 0.7, z, r * Math.cos(a), r * Math.sin(a), z]
      .map((v) => v.toFixed(6))
      .join(' ');
  }).join('\n'),
);

for (const [file, options, parameters] of [
  [scans, ['--resolution', '64'], {place: {resolution: 64}}],
  [
    scans,
    ['--resolution', '48', '--directions', 'estimate'],
    {place: {resolution: 48}, orient: {directions: 'estimate'}},
  ],
  [scans, ['--resolution', '40', '--method', 'poisson'], {place: {resolution: 40}, solve: {method: 'poisson'}}],
  [text, ['--distance'], {surface: {distance: true}}],
]) {
  const native = join(out, 'native.ply');
  run('reconstruct', file, '-o', native, ...options);
  const began = performance.now();
  const web = await inBrowser(file, parameters);
  const seconds = ((performance.now() - began) / 1000).toFixed(1);
  const same = withoutComments(readFileSync(native)) === withoutComments(web);
  writeFileSync(join(out, 'web.ply'), web);
  assert.ok(same, `${basename(file)} ${options.join(' ')}: other bytes than the program's, see ${out}`);
  console.log(`${basename(file)} ${options.join(' ')}: the same ${web.length} bytes, ${seconds} s`);
}

await assert.rejects(inBrowser(text, {place: {voxel: -1}}), /voxel/);
console.log('a bad voxel is refused in one line');
