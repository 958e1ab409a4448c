// node build.mjs NODE_MODULES OUT: bundles the viewer into OUT/page.html, one file that needs nothing else, and writes
// it as C++ text (OUT/page.cpp) that the program carries. tools/view/page.cpp fills the title and the data in.
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));

export function bundler(modules) {
  const esbuild = createRequire(join(modules, 'modules.js'))('esbuild');
  return {
    /** The text of an entry with all that it imports, minified. */
    async bundle(entry, format = 'esm') {
      const result = await esbuild.build({
        entryPoints: [entry],
        nodePaths: [modules],
        bundle: true,
        minify: true,
        write: false,
        format,
        target: ['chrome100', 'firefox100', 'safari15.4'],
        legalComments: 'none',
      });
      return result.outputFiles[0].text.trim();
    },

    /** The licenses of the libraries ask for their notice in every copy. As the inside of a comment. */
    notices() {
      const licenses = [
        ['three.js', 'three/LICENSE'],
        ['meshoptimizer', 'meshoptimizer/LICENSE.md'],
      ];
      const texts = licenses.map(([name, file]) => `${name}\n${readFileSync(join(modules, file), 'utf8').trim()}`);
      return texts.join('\n\n').replaceAll('--', '- -');
    },
  };
}

/** C++ raw text: no piece longer than compilers promise to take. */
function cpp(text) {
  const pieces = [];
  for (let at = 0; at < text.length; at += 16000) pieces.push(`R"~page~(${text.slice(at, at + 16000)})~page~"`);
  return (
    '// Made by viewer/build.mjs.\n#include "tools/view/page.h"\n\nnamespace soapfilm::view_detail {\n\n' +
    `std::string_view built_page() {\n  static constexpr char text[] =\n${pieces.join('\n')};\n` +
    '  return {text, sizeof(text) - 1};\n}\n\n}  // namespace soapfilm::view_detail\n'
  );
}

async function main() {
  const [modules, out] = process.argv.slice(2).map((path) => resolve(path));
  const {bundle, notices} = bundler(modules);
  const script = (await bundle(join(here, 'src/main.js'))).replaceAll('</script', '<\\/script');
  const parts = {STYLE: await bundle(join(here, 'src/style.css')), SCRIPT: script, LICENSES: notices()};
  const page = readFileSync(join(here, 'src/page.html'), 'utf8').replace(
    /@(STYLE|SCRIPT|LICENSES)@/g,
    (_, name) => parts[name],
  );
  mkdirSync(out, {recursive: true});
  writeFileSync(join(out, 'page.html'), page);
  writeFileSync(join(out, 'page.cpp'), cpp(page));
}

if (import.meta.url === pathToFileURL(resolve(process.argv[1] ?? '')).href) await main();
