// Bundles the page's own script and its libraries into one file, FOLDER/page.js, with their licences:
//
//   node build.mjs FOLDER
import { build } from 'esbuild';
import { readFileSync, writeFileSync, mkdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const into = process.argv[2];
if (!into) throw new Error('usage: node build.mjs FOLDER');
mkdirSync(into, { recursive: true });
await build({
  entryPoints: [join(here, 'src', 'main.js')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  // A file that is opened from disk has no other script to load.
  outfile: join(into, 'page.js'),
  legalComments: 'none',
  logLevel: 'warning',
});
const { dependencies } = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));
const read = (name, file) => readFileSync(join(here, 'node_modules', name, file), 'utf8');
// astronomy-engine states its licence in the first comment of its source.
const licences = {
  three: () => read('three', 'LICENSE'),
  meshoptimizer: () => read('meshoptimizer', 'LICENSE.md'),
  'astronomy-engine': () => /\/\*\*([\s\S]*?)\*\//.exec(read('astronomy-engine', 'astronomy.js'))[1].replace(/^ *\* ?/gm, ''),
};
const parts = Object.entries(dependencies).map(
  ([name, version]) => `${name} ${version}\n\n${licences[name]().trim()}\n`);
writeFileSync(join(into, 'LICENSES.txt'), parts.join('\n----\n\n'));
