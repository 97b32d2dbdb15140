// Checks the glTF files in a folder with the validator of the Khronos Group, draws some of them in
// Chromium by three.js, and stores the pictures in the folder: node gltf.mjs FOLDER

import assert from 'node:assert/strict';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { buildSync } from 'esbuild';
import { validateBytes } from 'gltf-validator';
import { PNG } from 'pngjs';
import { launch } from 'puppeteer-core';

const folder = process.argv[2];
const files = readdirSync(folder).filter((name) => name.endsWith('.glb')).sort();
assert.ok(files.length >= 20, `${files.length} files`);

let bytes = 0;
for (const name of files) {
  const file = readFileSync(join(folder, name));
  const { issues } = await validateBytes(new Uint8Array(file), { maxIssues: 20 });
  const found = issues.messages.filter(({ severity }) => severity < 2);
  assert.equal(issues.numErrors + issues.numWarnings, 0, `${name}: ${JSON.stringify(found, null, 1)}`);
  bytes += file.length;
}
console.log(`validator: no error and no warning in ${files.length} files of ${Math.round(bytes / 1000)} kB`);

const viewer = `
  import { AnimationMixer, Color, WebGLRenderer } from 'three';
  import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
  globalThis.draw = async (file, name, time) => {
    const bytes = Uint8Array.from(atob(file), (c) => c.charCodeAt(0));
    const { scene, cameras, animations } = await new GLTFLoader().parseAsync(bytes.buffer, '');
    scene.background = new Color(0);
    const mixer = new AnimationMixer(scene);
    if (animations.length > 0) mixer.clipAction(animations[0]).play();
    mixer.setTime(time);
    const camera = cameras.find((found) => found.name === name);
    camera.aspect = 640 / 480;
    camera.updateProjectionMatrix();
    const canvas = document.querySelector('canvas');
    const renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    renderer.setSize(640, 480, false);
    renderer.render(scene, camera);
    const count = (property) => scene.getObjectsByProperty(property, true).length;
    return { url: canvas.toDataURL('image/png'), nodes: count('isMesh'), skins: count('isSkinnedMesh') };
  };`;
const { outputFiles } = buildSync({
  stdin: { contents: viewer, resolveDir: fileURLToPath(new URL('.', import.meta.url)) },
  bundle: true,
  format: 'iife',
  write: false,
});

const browser = await launch({
  headless: true,
  executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
  const page = await browser.newPage();
  const problems = [];
  page.on('console', (message) => ['error', 'warn'].includes(message.type()) && problems.push(message.text()));
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.setContent('<canvas width="640" height="480"></canvas>');
  await page.addScriptTag({ content: outputFiles[0].text });
  const draw = async (name, camera, time) => {
    const file = readFileSync(join(folder, `${name}.glb`)).toString('base64');
    const { url, nodes, skins } = await page.evaluate((...of) => globalThis.draw(...of), file, camera, time);
    assert.ok(nodes > 5, `${name} has ${nodes} meshes`);
    assert.equal(skins, name === 'skin' ? 1 : 0, `${name} has ${skins} meshes with bones`);
    const png = Buffer.from(url.split(',')[1], 'base64');
    writeFileSync(join(folder, `gltf-${name}-${time}.png`), png);
    return PNG.sync.read(png).data;
  };
  const difference = (a, b) => a.reduce((sum, value, i) => sum + (i % 4 < 3 ? Math.abs(value - b[i]) : 0), 0) / (640 * 480 * 3);
  for (const [name, camera, time] of [['humanoid', 'side', 0.4], ['shapes', 'front', 0.15], ['skin', 'front', 0.3]]) {
    const start = await draw(name, camera, 0);
    assert.ok(start.some((value, i) => i % 4 < 3 && value > 100), `${name} has a bright picture`);
    const later = difference(start, await draw(name, camera, time));
    assert.ok(later > 0.2, `${name} moves: ${later}`);
    console.log(`chromium: ${name}.glb moves, by ${later.toFixed(2)} of 255 in ${time} s`);
  }
  // SwiftShader warns about its own stalls.
  assert.deepEqual(problems.filter((text) => !/GPU stall/.test(text)), []);
} finally {
  await browser.close();
}
