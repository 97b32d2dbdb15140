// Builds src/html/page.html and src/html/program.js.gz from src/: npm ci && npm run build
//
// With --check compares them with the committed ones instead.

import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { gunzipSync, gzipSync } from 'node:zlib';
import { buildSync, transformSync } from 'esbuild';

process.chdir(fileURLToPath(new URL('.', import.meta.url)));
const read = (path) => readFileSync(path, 'utf8');
const licence = read('node_modules/three/LICENSE').trim();

const { outputFiles } = buildSync({
  absWorkingDir: process.cwd(),
  entryPoints: ['src/start.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  legalComments: 'none',
  // Older browsers and proxies may guess another encoding.
  charset: 'ascii',
  banner: { js: `/* mujoco-safe, with three.js:\n\n${licence}\n*/` },
  write: false,
});
const program = outputFiles[0].text;
const loader = transformSync(read('src/loader.js'), { minify: true, target: 'es2022' }).code.trim();
const style = transformSync(read('src/style.css'), { minify: true, loader: 'css' }).code.trim();
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const page = read('src/page.html')
  .replace('LOADER_HASH', hash(loader))
  .replace('PROGRAM_HASH', hash(program))
  .replace('STYLE_HASH', hash(style))
  .replace('STYLE', () => style)
  .replace('LOADER', () => loader);

const [pagePath, programPath] = ['../src/html/page.html', '../src/html/program.js.gz'];
if (process.argv.includes('--check')) {
  // The compressed bytes depend on the version of zlib.
  const isEqual = read(pagePath) === page && gunzipSync(readFileSync(programPath)).toString() === program;
  if (!isEqual) throw new Error('src/html/page.html or program.js.gz is out of date: npm run build');
} else {
  writeFileSync(pagePath, page);
  writeFileSync(programPath, gzipSync(program, { level: 9 }));
}
console.log(`program: ${program.length} bytes, ${gzipSync(program, { level: 9 }).length} compressed`);
