// The engine of the browser gives the same mesh, byte for byte, as the program, and reads each kind of single file as
// it does: node bytes.mjs PROGRAM MODULE FOLDER, where MODULE is soapfilm.mjs of the npm package. With real files, too,
// and with whole scenes, where the variable SOAPFILM_DATA names the folder of the real ones.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {copyFileSync, mkdirSync, readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, dirname, extname, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {withoutComments} from './ply.mjs';

const [program, module, out] = process.argv.slice(2).map((path) => resolve(path));
mkdirSync(out, {recursive: true});
const {engine} = await import(pathToFileURL(module));
const run = (...args) => execFileSync(program, [...args, '--quiet'], {stdio: ['ignore', 'ignore', 'inherit']});

/** The scans that a set names lie beside it. */
const scansOf = (file) =>
  extname(file) !== '.conf'
    ? []
    : [...readFileSync(file, 'utf8').matchAll(/^bmesh (\S+)/gm)].map(([, name]) => join(dirname(file), name));

async function inBrowser(file, parameters) {
  const events = [];
  const soapfilm = await engine((kind, fraction, text) => events.push([kind, fraction, text]));
  for (const path of [file, ...scansOf(file)]) soapfilm.put(basename(path), readFileSync(path));
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

async function compare(file, options, parameters) {
  const native = join(out, 'native.ply');
  run('reconstruct', file, '-o', native, ...options);
  const began = performance.now();
  const web = await inBrowser(file, parameters);
  const seconds = ((performance.now() - began) / 1000).toFixed(1);
  const program = readFileSync(native);
  const same = withoutComments(program) === withoutComments(web);
  writeFileSync(join(out, 'web.ply'), web);
  const name = `${basename(dirname(file))}/${basename(file)} ${options.join(' ')}`;
  assert.ok(same, `${name}: other bytes than the program's, see ${out}`);
  const [, triangles] = program.toString('latin1', 0, 4000).match(/element face (\d+)/);
  console.log(`${name}: the same ${web.length} bytes, ${triangles} triangles, ${seconds} s`);
  return Number(triangles);
}

for (const [file, options, parameters] of [
  [scans, ['--resolution', '64'], {place: {resolution: 64}}],
  [
    scans,
    ['--resolution', '48', '--directions', 'estimate'],
    {place: {resolution: 48}, orient: {directions: 'estimate'}},
  ],
  [scans, ['--resolution', '40', '--method', 'poisson'], {place: {resolution: 40}, solve: {method: 'poisson'}}],
  [text, ['--distance'], {surface: {distance: true}}],
])
  await compare(file, options, parameters);

// So many triangles that the number of one and that of its place in the grid do not fit into 32 bits together; and the
// few views leave holes, so that the last moves of vertices make crossings, which are found by these numbers.
run('scan', 'knot', '-o', join(out, 'large'), '--views', '6', '--image', '200x200', '--seed', '5');
const large = await compare(join(out, 'large/scans.conf'), ['--resolution', '200'], {place: {resolution: 200}});
assert.ok(large > 200000, `${large} triangles are too few to tell`);

if (process.env.SOAPFILM_DATA) {
  const bunny = join(process.env.SOAPFILM_DATA, 'bunny/bun.conf');
  await compare(bunny, ['--voxel', '0.0014'], {place: {voxel: 0.0014}});
  for (const scene of ['room', 'terrain', 'street']) {
    run('scan', scene, '-o', join(out, scene));
    await compare(join(out, scene, 'scans.conf'), [], {});
  }
}

/** What the program says of a file: its facts, or the line that refuses it. */
function byProgram(file) {
  const {status, stdout, stderr} = spawnSync(program, ['info', '--json', file], {encoding: 'utf8'});
  return status === 0 ? {facts: JSON.parse(stdout)[0]} : {refusal: stderr.replace('soapfilm: ', '').trim()};
}

/** The same by the engine. */
async function byEngine(file) {
  const warnings = [];
  const soapfilm = await engine((kind, _, text) => kind === 'warning' && warnings.push(text));
  soapfilm.put(basename(file), readFileSync(file));
  try {
    soapfilm.read(basename(file));
    return {summary: soapfilm.summary(), warnings};
  } catch (error) {
    return {refusal: error.message};
  }
}

const seeds = join(out, 'seeds');
const formats = ['.ply', '.ptx', '.e57', '.las', '.pcd', '.xyz', '.csv', '.npy', '.bin', '.obj', '.off', '.laz'];
execFileSync('python3', ['-B', 'fuzz/seeds.py', seeds, ...formats]);
const named = join(out, 'formats');
mkdirSync(named, {recursive: true});
for (const extension of formats)
  for (const seed of readdirSync(join(seeds, extension)))
    copyFileSync(join(seeds, extension, seed), join(named, `${seed}${extension}`));
const folders = [named];
if (process.env.SOAPFILM_DATA) folders.push(join(process.env.SOAPFILM_DATA, 'formats'));
const read = new Map(),
  refused = new Map();
for (const folder of folders) {
  for (const name of readdirSync(folder).filter((name) => formats.includes(extname(name)))) {
    const file = join(folder, name);
    const expected = byProgram(file);
    if (expected.facts?.kind === 'mesh') continue;
    const found = await byEngine(file);
    const inPage = (line) => line?.replaceAll(folder, '/in');
    assert.equal(found.refusal, inPage(expected.refusal), file);
    const counts = expected.facts ? read : refused;
    counts.set(extname(name), (counts.get(extname(name)) ?? 0) + 1);
    if (!expected.facts) continue;
    const {samples, scans, box, warnings} = expected.facts;
    assert.deepEqual([found.summary.samples, found.summary.scans], [samples, scans.length], file);
    assert.deepEqual([found.summary.box.lo, found.summary.box.hi], [box.lo, box.hi], file);
    assert.deepEqual(found.warnings, warnings.map(inPage), file);
  }
}
for (const extension of formats.filter((name) => name !== '.obj'))
  assert.ok(read.get(extension) > 0, `no ${extension} was read`);
const counted = (counts) => [...counts].map(([extension, count]) => `${count} ${extension}`).join(', ');
console.log(`read as the program reads them: ${counted(read)}; refused in the same words: ${counted(refused)}`);

await assert.rejects(inBrowser(text, {place: {voxel: -1}}), /voxel/);
console.log('a bad voxel is refused in one line');
