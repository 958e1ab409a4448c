// The npm package as a user gets it: node npm.mjs PROGRAM FOLDER TARBALL. It is installed from the tarball into an
// empty project in FOLDER, and the programs of the guide run there as they stand, by `import` and by `require`.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';

const [program, out, tarball] = process.argv.slice(2).map((path) => resolve(path));
const project = join(out, 'npm');
rmSync(project, {recursive: true, force: true});
mkdirSync(project, {recursive: true});
const node = (...args) => execFileSync('node', args, {cwd: project, encoding: 'utf8'});

execFileSync(program, ['scan', 'knot', '-o', join(out, 'knot'), '--samples', '20000', '--seed', '5', '--quiet']);
copyFileSync(join(out, 'knot/samples.ply'), join(project, 'samples.ply'));
writeFileSync(join(project, 'package.json'), '{"private": true}\n');
const options = ['--offline', '--no-audit', '--no-fund', '--ignore-scripts', '--silent'];
execFileSync('npm', ['install', ...options, tarball], {cwd: project, stdio: 'inherit'});

const guide = readFileSync('docs/guide/browser.md', 'utf8');
const copy = (name) => {
  const [, text] = guide.match(new RegExp(`<!-- file: ${name} -->\\n\`\`\`js\\n([^]*?)\`\`\``));
  writeFileSync(join(project, name), text);
};
const meshes = ['mjs', 'cjs'].map((kind) => {
  copy(`mesh.${kind}`);
  rmSync(join(project, 'mesh.glb'), {force: true});
  const printed = node(`mesh.${kind}`);
  assert.match(printed, /\d+ triangles\n$/);
  if (kind === 'mjs') {
    assert.match(printed, /smallest_voxel: 0\.0/);
    assert.match(printed, /\d+ vertices with distance, \d+ triangles\n$/);
  }
  const mesh = readFileSync(join(project, 'mesh.glb'));
  assert.equal(mesh.toString('latin1', 0, 4), 'glTF');
  return mesh;
});
assert.ok(meshes[0].equals(meshes[1]), 'import and require give different meshes');

copy('small.mjs');
const [, left, before, proved] = node('small.mjs').match(/^(\d+) of (\d+) triangles, within (\S+)\n$/);
assert.ok(left <= 2000 && left > 1500 && before > 5000 && proved > 0 && proved < 0.01, `${left} of ${before}, ${proved}`);
const [small] = JSON.parse(execFileSync(program, ['info', '--json', join(project, 'small.glb')], {encoding: 'utf8'}));
assert.equal(small.triangles, Number(left));

const version = execFileSync(program, ['--version'], {encoding: 'utf8'}).match(/\d+\.\d+\.\d+/)[0];
const asks = "console.log(require('soapfilm/package.json').version, require.resolve('soapfilm'))";
const [stated, path] = node('-e', asks).trim().split(' ');
assert.equal(stated, version);
assert.match(path, /soapfilm\.cjs$/);
assert.equal(node('-e', "require('soapfilm').engine().then((one) => console.log(one.version()))").trim(), version);
const resolved = node('--input-type=module', '-e', "console.log(import.meta.resolve('soapfilm'))");
assert.match(resolved, /soapfilm\.mjs\n$/);

// The types name the functions that are there.
const installed = join(project, 'node_modules/soapfilm');
const named = 'import("soapfilm").then(({engine}) => engine()).then((one) => console.log(Object.keys(one).join()))';
const functions = node('-e', named).trim().split(',');
for (const kind of ['mts', 'cts']) {
  const [, body] = readFileSync(join(installed, `soapfilm.d.${kind}`), 'utf8').match(/interface Engine {\n([^]*?)\n}/);
  const typed = new Set([...body.matchAll(/^ {2}(\w+)\(/gm)].map(([, name]) => name));
  assert.deepEqual([...typed].sort(), [...functions].sort());
}

const licenses = readFileSync(join(installed, 'LICENSES.txt'), 'utf8');
for (const name of ['Eigen', 'nanoflann', 'pugixml', 'musl']) assert.match(licenses, new RegExp(name, 'i'));
console.log(`soapfilm ${version} by import and by require: the same mesh, ${meshes[0].length} bytes`);
