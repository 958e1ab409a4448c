// simplify() of the npm package: the program's bytes, for files and for arrays, and what it refuses:
// node simplify.mjs PROGRAM MODULE FOLDER, as bytes.mjs.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {arraysOf, withoutComments} from './ply.mjs';

const [program, module, out] = process.argv.slice(2).map((path) => resolve(path));
mkdirSync(out, {recursive: true});
const {engine} = await import(pathToFileURL(module));
const run = (...args) => execFileSync(program, [...args, '--quiet'], {stdio: ['ignore', 'ignore', 'inherit']});

run('scan', 'knot', '-o', join(out, 'knot'), '--samples', '20000', '--noise', '0.3%', '--seed', '5');
const scans = join(out, 'knot/samples.ply'),
  full = join(out, 'full.ply'),
  few = join(out, 'few.ply');
run('reconstruct', scans, '-o', full, '--resolution', '64');
const arrays = arraysOf(readFileSync(full));
const doubles = {...arrays, positions: Float64Array.from(arrays.positions)};

// Of a file that is put, of its arrays in float and in double.
for (const [options, target] of [
  [['--tolerance', '0.0005'], {tolerance: 0.0005}],
  [['--triangles', '900'], {triangles: 900}],
]) {
  run('simplify', full, '-o', few, ...options);
  const expected = withoutComments(readFileSync(few));
  for (const mesh of ['full.ply', arrays, doubles]) {
    const soapfilm = await engine();
    if (mesh === 'full.ply') soapfilm.put(mesh, readFileSync(full));
    const {mesh: found, report} = soapfilm.simplify(mesh, target);
    assert.ok(withoutComments(Buffer.from(soapfilm.write('few.ply'))) === expected, `simplify ${options}: other bytes`);
    const wanted = arraysOf(readFileSync(few));
    assert.equal(found.positions.constructor, mesh === arrays ? Float32Array : Float64Array);
    assert.deepEqual([...found.positions], [...wanted.positions]);
    assert.deepEqual(found.indices, wanted.indices);
    assert.equal(report.triangles, found.indices.length / 3);
    assert.equal(report.triangles_before, arrays.indices.length / 3);
    assert.ok(report.proved > 0 && report.proved <= report.tolerance, JSON.stringify(report));
    assert.deepEqual(JSON.parse(soapfilm.report()), report);
  }
}

// Of what was just reconstructed.
const soapfilm = await engine();
assert.throws(() => soapfilm.simplify(null, {tolerance: 1}), /no mesh yet/);
soapfilm.put('samples.ply', readFileSync(scans));
soapfilm.read('samples.ply');
soapfilm.reconstruct({place: {resolution: 64}, surface: {distance: true}});
const {mesh} = soapfilm.simplify(null, {tolerance: 0.002});
assert.ok(mesh.indices.length < arrays.indices.length / 2);
assert.equal(mesh.attributes[0].name, 'distance');
assert.equal(mesh.attributes[0].values.length, mesh.positions.length / 3);

// A red half and an attribute come along, in the order in which they were given.
const {positions, indices} = arrays;
const red = Uint8Array.from(positions, (_, i) => (i % 3 === 0 && positions[i] > 0 ? 255 : 0));
const heights = Float32Array.from({length: positions.length / 3}, (_, i) => positions[3 * i]);
const given = {positions, indices, colors: red, normals: positions, attributes: [{name: 'height', values: heights}]};
const {mesh: colored} = soapfilm.simplify(given, {triangles: 2000});
const beyond = 0.02; // nearer to the seam colors are mixed
colored.attributes[0].values.forEach((x, i) => {
  assert.ok(Math.abs(x - colored.positions[3 * i]) < 0.01, `height of vertex ${i}: ${x}`);
  if (Math.abs(x) > beyond) assert.equal(colored.colors[4 * i], x > 0 ? 255 : 0, `vertex ${i} at ${x}`);
});
assert.equal(colored.normals.length, colored.positions.length);

// What is refused leaves the mesh that is there.
const kept = soapfilm.write('kept.ply');
const corner = {positions: [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], indices: [0, 1, 2]};
for (const [mesh, target, message] of [
  [arrays, {}, /simplify: give a tolerance, or triangles: N/],
  [arrays, {tolerance: 1, triangles: 2}, /simplify: give a tolerance/],
  [arrays, {tolerance: -1}, /tolerance = -1, must be > 0/],
  [arrays, {triangles: 1.5}, /triangles = 1.5, must be a whole number/],
  [undefined, {tolerance: 1}, /mesh: neither arrays/],
  [{...corner, positions: [1, 2]}, {tolerance: 1}, /mesh: positions has 2 values, must be 3 each/],
  [{...corner, indices: [0, 1, 4]}, {tolerance: 1}, /mesh: triangle 0: vertex 4, must be below 4/],
  [{...corner, indices: [0, 1, 0.5]}, {tolerance: 1}, /mesh: triangle 0: vertex 0.5/],
  [{...corner, normals: [0, 0, 1]}, {tolerance: 1}, /mesh: normals has 1 rows for 4 vertices/],
  [{...corner, positions: [NaN, ...corner.positions.slice(1)]}, {tolerance: 1}, /mesh: vertex 0 is not finite/],
  [{...corner, indices: [0, 1, 2, 0, 1, 3]}, {tolerance: 1}, /mesh: edge 0-1 .*2-manifold/],
  ['nothing.ply', {tolerance: 1}, /nothing\.ply/],
])
  assert.throws(() => soapfilm.simplify(mesh, target), message);
assert.deepEqual(soapfilm.write('kept.ply'), kept);
console.log('simplify: the same bytes for a file and for arrays; what cannot be is refused');
