// node package.mjs NODE_MODULES ENGINE OUT: makes the npm package in OUT/npm and packs it as OUT/soapfilm-VERSION.tgz.
// ENGINE is soapfilm.js of web/CMakeLists.txt. The package has the same functions twice: soapfilm.mjs for `import`,
// soapfilm.cjs for `require`; each is one file that needs nothing else. Types lie beside both.
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {bundler} from '../viewer/build.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const root = dirname(here);
const [modules, engine, out] = process.argv.slice(2).map((path) => resolve(path));
const {bundle} = bundler(modules);
const [, version] = readFileSync(join(root, 'CMakeLists.txt'), 'utf8').match(/^project\(soapfilm VERSION ([\d.]+)/m);

/** The licenses of what is compiled in ask for their notice in every copy. */
function notices() {
  const rows = readFileSync(join(root, 'packaging/licenses.txt'), 'utf8').matchAll(/^(\S+) .*\[.*\bnpm\b.*\]$/gm);
  const files = [...rows].map(([, name]) => `/usr/share/doc/${name}/copyright`);
  files.push(...['Apache-2.0', 'MPL-2.0'].map((name) => `/usr/share/common-licenses/${name}`)); // which these name
  return files.map((file) => `======== Debian's ${file}\n\n${readFileSync(file, 'utf8').trim()}\n`).join('\n');
}

// Emscripten's text asks where it runs. Without these names it takes node for a browser, and so needs no `require`,
// which an ES module does not have; wasm lies inside, nothing is loaded from a file.
const create = `const createSoapfilm = ((process, require, module, exports, define) => {
${readFileSync(engine, 'utf8')}
return createSoapfilm;
})();
`;
const description = {
  name: 'soapfilm',
  version,
  description: 'Watertight surfaces from raw 3D scans, with a proof of how near they are to the best ones',
  keywords: ['surface reconstruction', 'point cloud', '3D scan', 'mesh', 'wasm'],
  license: 'MIT',
  main: './soapfilm.cjs',
  module: './soapfilm.mjs',
  types: './soapfilm.d.cts',
  exports: {
    '.': {
      import: {types: './soapfilm.d.mts', default: './soapfilm.mjs'},
      require: {types: './soapfilm.d.cts', default: './soapfilm.cjs'},
    },
    './package.json': './package.json',
  },
  files: ['soapfilm.*', 'LICENSES.txt'],
  engines: {node: '>=18'},
  sideEffects: false,
};

const folder = join(out, 'npm');
rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
for (const [name, format] of [
  ['soapfilm.mjs', 'esm'],
  ['soapfilm.cjs', 'cjs'],
])
  writeFileSync(join(folder, name), `${create}${await bundle(join(here, 'src/package.js'), format)}\n`);
for (const kind of ['mts', 'cts']) copyFileSync(join(here, 'src/soapfilm.d.ts'), join(folder, `soapfilm.d.${kind}`));
writeFileSync(join(folder, 'package.json'), `${JSON.stringify(description, null, 2)}\n`);
writeFileSync(join(folder, 'LICENSES.txt'), notices());
copyFileSync(join(root, 'LICENSE'), join(folder, 'LICENSE'));
copyFileSync(join(here, 'npm.md'), join(folder, 'README.md'));
execFileSync('npm', ['pack', '--silent', '--pack-destination', out, folder], {stdio: ['ignore', 'ignore', 'inherit']});
