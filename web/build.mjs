// node build.mjs NODE_MODULES ENGINE OUT: makes OUT/index.html, the page that reconstructs in the browser, one file that
// asks the network for nothing. ENGINE is soapfilm.js of web/CMakeLists.txt. For other pages: package.mjs.
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {bundler} from '../viewer/build.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const [modules, engine, out] = process.argv.slice(2).map((path) => resolve(path));
const {bundle, notices} = bundler(modules);
const inScript = (text) => text.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');

const viewer = join(here, '../viewer/src');
const worker = `${readFileSync(engine, 'utf8')}\n${await bundle(join(here, 'src/worker.js'), 'iife')}`;
const style = `${await bundle(join(viewer, 'style.css'))}\n${await bundle(join(here, 'src/web.css'))}`;
const parts = {STYLE: style, SCRIPT: inScript(await bundle(join(here, 'src/main.js'))), LICENSES: notices()};
const page = readFileSync(join(viewer, 'page.html'), 'utf8')
  .replace('<!--soapfilm:title-->', 'Soapfilm')
  .replace(/<script type="application\/json" id="scene">.*<\/script>/, () =>
    readFileSync(join(here, 'src/welcome.html'), 'utf8'),
  )
  .replace('<!--soapfilm:data-->', () => `<script type="text/plain" id="worker">${inScript(worker)}</script>`)
  .replace("default-src 'none';", "default-src 'none'; worker-src blob:;")
  .replace(/@(STYLE|SCRIPT|LICENSES)@/g, (_, name) => parts[name]);
mkdirSync(out, {recursive: true});
writeFileSync(join(out, 'index.html'), page);
