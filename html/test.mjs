// Tests the pages in a folder, and those that the addresses in its files *.url serve, in Chromium and
// Firefox, and stores screenshots of a phone's size there. With LOOK=yes also those of a laptop's size,
// and the times of first pictures are printed:
// node test.mjs FOLDER [chromium|firefox]

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import assert from 'node:assert/strict';
import { PNG } from 'pngjs';
import { launch } from 'puppeteer-core';

const BROWSERS = {
  chromium: {
    executablePath: '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-prefers-reduced-motion'],
  },
  firefox: {
    browser: 'firefox',
    // WebGL needs a display: scripts/try-html starts one.
    headless: false,
    executablePath: '/usr/bin/firefox-esr',
    extraPrefsFirefox: { 'webgl.force-enabled': true, 'ui.prefersReducedMotion': 1 },
  },
};
/**
 * Largest mean difference of the colours of a page and of the renderer, of 255. The other scene has
 * bright haze, which the page does not draw, and highlights of lights with different colours.
 */
const TOLERANCES = { humanoid: 2, shapes: 8, soft: 2 };

/** Largest mean difference of two pictures of the same state by the same program, of 255. */
const SAME = 0.05;

const [folder, only] = process.argv.slice(2);

async function open(browser, file, { width, height, scale = 1, touch = false, dark = false, hash = '', script = () => {} }) {
  const page = await browser.newPage();
  const problems = [];
  page.on('console', (message) => ['error', 'warn'].includes(message.type()) && problems.push(message.text()));
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('dialog', (dialog) => problems.push(`a dialog: ${dialog.message()}`));
  await page.setViewport({ width, height, deviceScaleFactor: scale, hasTouch: touch });
  if (dark) await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }]);
  await page.evaluateOnNewDocument(script);
  const served = file.endsWith('.url');
  const address = served ? readFileSync(join(folder, file), 'utf8') : pathToFileURL(join(folder, file)).href;
  await page.goto(address + hash);
  await page.waitForFunction(() => document.documentElement.dataset.state, { timeout: 60000 });
  assert.equal(await page.evaluate(() => document.documentElement.dataset.state), 'ready', problems.join('\n'));
  if (served) await page.waitForFunction(() => document.documentElement.dataset.live === 'open', { timeout: 60000 });
  return { page, problems };
}

/**
 * Stores the milliseconds from the start of the navigation until the page has issued the commands
 * of its first picture, and until a pixel of it can be read: then the software has drawn it.
 */
function timeFirstPicture() {
  const observer = new MutationObserver(() => {
    observer.disconnect();
    const issued = performance.now();
    const context = document.getElementById('canvas').getContext('webgl2');
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
    globalThis.firstPicture = [issued, performance.now()];
  });
  observer.observe(document, { subtree: true, attributeFilter: ['data-state'] });
}

/** Prints the times of first pictures: medians of five new tabs, after one that is not counted. */
async function printFirstPictures(browser, name) {
  for (const file of ['humanoid', 'robot', 'rollouts']) {
    const all = [];
    for (let tab = 0; tab < 6; tab++) {
      const size = { width: 1280, height: 720 };
      const { page, problems } = await open(browser, `${file}.html`, { ...size, script: timeFirstPicture });
      all.push(await page.evaluate(() => globalThis.firstPicture));
      assert.deepEqual(problems, []);
      await page.close();
    }
    const median = (times) => (times.sort((a, b) => a - b)[2] / 1000).toFixed(2);
    const [issued, readable] = [0, 1].map((part) => median(all.slice(1).map((times) => times[part])));
    console.log(`${name}: first picture of ${file}: commands after ${issued} s, drawn after ${readable} s (medians of 5 tabs)`);
  }
}

const text = (page, selector) => page.$eval(selector, (element) => element.textContent);
const canvas = async (page) => PNG.sync.read(Buffer.from(await (await page.$('#canvas')).screenshot()));
const settle = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Mean difference of the colours of two pictures. */
function difference(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  let sum = 0;
  for (let i = 0; i < a.data.length; i++) sum += i % 4 < 3 ? Math.abs(a.data[i] - b.data[i]) : 0;
  return sum / (a.width * a.height * 3);
}

/** Standard deviation of the colours of a picture. */
function contrast({ data }) {
  const values = data.filter((_, i) => i % 4 < 3);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  return Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length);
}

async function time(page) {
  return Number.parseFloat(await text(page, '#time'));
}

async function testControls(browser, name) {
  const { page, problems } = await open(browser, 'humanoid.html', { width: 1280, height: 720 });
  const before = await canvas(page);
  assert.ok(contrast(before) > 10, 'the picture is not empty');
  assert.equal(await text(page, '#play'), '');
  assert.equal(await time(page), 0);

  await page.keyboard.press('ArrowRight');
  assert.ok((await time(page)) > 0.01, 'an arrow goes to the next record');
  await page.keyboard.press('Home');
  assert.equal(await time(page), 0);
  const seek = await (await page.$('#seek')).boundingBox();
  await page.mouse.click(seek.x + seek.width / 2, seek.y + seek.height / 2);
  assert.ok(Math.abs((await time(page)) - 1.5) < 0.1, 'a click on the timeline seeks');
  await settle(page);
  assert.ok(difference(before, await canvas(page)) > 1, 'a seek changes the picture');
  const plot = await (await page.$('#plots canvas')).boundingBox();
  await page.mouse.click(plot.x + plot.width / 4, plot.y + plot.height / 2);
  assert.ok(Math.abs((await time(page)) - 0.75) < 0.1, 'a click in a plot seeks');
  assert.match(await text(page, '#note'), /falls/);

  await page.keyboard.press('Home');
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press(' ');
  await page.waitForFunction(() => Number.parseFloat(document.getElementById('time').textContent) > 0.2);
  await page.click('#play');
  const stopped = await time(page);
  await settle(page);
  assert.equal(await time(page), stopped, 'a second press pauses');
  await page.keyboard.press('End');
  await page.keyboard.press('l');
  assert.equal(await page.$eval('#loop', (button) => button.getAttribute('aria-pressed')), 'false');
  await page.select('#speed', '2');

  await page.keyboard.press('Home');
  const side = await canvas(page);
  await page.select('#camera', '0');
  await settle(page);
  const free = await canvas(page);
  assert.ok(difference(side, free) > 1, 'another camera has another picture');
  const box = await (await page.$('#canvas')).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 150, y + 20, { steps: 4 });
  await page.mouse.up();
  await settle(page);
  assert.ok(difference(free, await canvas(page)) > 1, 'a drag rotates the free camera');
  await page.mouse.click(x, y);
  assert.match(await text(page, '#selection'), /Body.+Position/, 'a click selects');
  await page.screenshot({ path: join(folder, `${name}-selected.png`) });
  const still = await canvas(page);
  await page.keyboard.press('f');
  assert.equal(await page.$eval('#follow', (button) => button.getAttribute('aria-pressed')), 'true');
  await page.keyboard.press('End');
  await settle(page);
  assert.ok(difference(still, await canvas(page)) > 1, 'the free camera follows');
  await page.keyboard.press('Home');
  await settle(page);
  assert.ok(difference(still, await canvas(page)) < 0.1, 'the free camera follows back');
  await page.keyboard.press('Escape');
  assert.ok(await page.$eval('#selection', (box) => box.hidden));
  await page.keyboard.press('?');
  await page.screenshot({ path: join(folder, `${name}-help.png`) });
  assert.deepEqual(problems, []);
  await page.close();
}

/** Returns the picture in the size of those of the renderer. */
async function smallCanvas(page) {
  await page.evaluate(() => {
    for (const id of ['plots', 'note']) document.getElementById(id).style.display = 'none';
    const view = document.querySelector('main');
    Object.assign(view.style, { width: '640px', height: '480px' });
  });
  await page.waitForFunction(() => document.getElementById('canvas').width === 640);
  await settle(page);
  return canvas(page);
}

/** Compares the picture of a camera with that of the renderer. */
async function testPicture(browser, name, model) {
  const expected = PNG.sync.read(readFileSync(join(folder, `${model}.png`)));
  const { page } = await open(browser, `${model}.html`, { width: 1280, height: 720 });
  const found = await smallCanvas(page);
  const value = difference(found, expected);
  await page.screenshot({ path: join(folder, `${name}-${model}-picture.png`) });
  assert.ok(value <= TOLERANCES[model], `the picture of ${model} differs by ${value} from the renderer's`);
  await page.close();
  return value;
}

/** Several trajectories in one place and side by side. */
async function testSeveral(browser, name) {
  const { page, problems } = await open(browser, 'side_by_side.html', { width: 1440, height: 900, hash: '#t=0.6' });
  await settle(page);
  const beside = await canvas(page);
  const shown = async (id, value) => {
    await page.select(`#${id}`, value);
    await settle(page);
    return canvas(page);
  };
  const ghosts = await shown('layout', '0');
  const one = await shown('layout', '2');
  assert.ok(difference(beside, ghosts) > 1 && difference(ghosts, one) > 0.2, 'the layouts differ');
  assert.ok(difference(await shown('track', '2'), one) > 0.5, 'another trajectory is drawn');
  await page.focus('#canvas').catch(() => {});
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('g');
  assert.equal(await page.$eval('#layout', (select) => select.value), '0');
  await shown('track', '0');
  assert.ok(difference(await shown('layout', '1'), beside) < 0.5, 'the camera returns');
  await page.screenshot({ path: join(folder, `${name}-side-by-side.png`) });
  // Along the row, so that a click meets each of them.
  const labels = new Set();
  const box = await (await page.$('#canvas')).boundingBox();
  for (let x = 0.05; x < 1; x += 0.01) {
    await page.mouse.click(box.x + x * box.width, box.y + 0.5 * box.height);
    const label = /rollout \d+/.exec(await text(page, '#selection'));
    if (label && !(await page.$eval('#selection', (selection) => selection.hidden))) labels.add(label[0]);
  }
  assert.ok(labels.size >= 2, `clicks select geoms of several trajectories: ${[...labels]}`);
  assert.deepEqual(problems, []);
  await page.close();
}

/** Milliseconds for a picture of 64 humanoids while they play. */
async function testMany(browser) {
  const { page, problems } = await open(browser, 'rollouts.html', { width: 1280, height: 720 });
  await page.click('#play');
  const period = await page.evaluate(
    () =>
      new Promise((done) => {
        const start = performance.now();
        let count = 0;
        const next = (now) => (++count > 20 || now - start > 20000 ? done((now - start) / count) : requestAnimationFrame(next));
        requestAnimationFrame(next);
      }),
  );
  assert.deepEqual(problems, []);
  await page.close();
  return period;
}

async function testBatch(browser, name) {
  const { page, problems } = await open(browser, 'batch.url', { width: 1280, height: 720 });
  await until(page, time, (now) => now > 0.1, 'the batch runs');
  assert.ok(await page.$eval('#pull', (button) => button.hidden) && (await page.$eval('#plots', (plots) => plots.hidden)));
  await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => !playing, 'the space bar pauses');
  const ghosts = await canvas(page);
  await page.select('#layout', '1');
  await settle(page);
  await settle(page);
  assert.ok(difference(ghosts, await canvas(page)) > 1, 'the simulations are side by side');
  await page.screenshot({ path: join(folder, `${name}-batch-side-by-side.png`) });
  await page.keyboard.press('r');
  await until(page, time, (now) => now === 0, 'a reset restores the time');
  await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => playing, 'the space bar resumes');
  assert.deepEqual(problems, []);
  await page.close();
}

/** A live page draws a tendon and a skin as the page of a recording does in the same state. */
async function testSoftLive(browser) {
  const recorded = await open(browser, 'soft.html', { width: 1280, height: 720 });
  const expected = await smallCanvas(recorded.page);
  await recorded.page.close();
  const { page, problems } = await open(browser, 'soft.url', { width: 1280, height: 720 });
  await until(page, time, Number.isFinite, 'the page shows the first state');
  if (await isPlaying(page)) await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => !playing, 'the space bar pauses');
  await page.keyboard.press('r');
  await until(page, time, (now) => now === 0, 'a reset restores the time');
  const value = difference(await smallCanvas(page), expected);
  assert.ok(value < SAME, `the live picture differs by ${value} from that of the recording`);
  assert.deepEqual(problems, []);
  await page.close();
  return value;
}

async function testHostile(browser) {
  const { page, problems } = await open(browser, 'hostile.html', { width: 1280, height: 720 });
  const box = await (await page.$('#canvas')).boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('?');
  await settle(page);
  assert.equal(await page.evaluate(() => globalThis.hacked), undefined);
  assert.equal(await page.$$eval('img, [onerror], [onfocus]', (found) => found.length), 0);
  assert.equal(await page.$$eval('script', (found) => found.length), 4, 'the page has only its own scripts');
  assert.match(await text(page, '#title'), /<script>/, 'names are shown as they are');
  assert.match(await text(page, '#selection'), /<img src=x/);
  // The policy stops a script that comes into the page in another way.
  await page.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'globalThis.hacked = 2';
    document.body.append(script);
  });
  assert.equal(await page.evaluate(() => globalThis.hacked), undefined);
  assert.ok(problems.every((problem) => /Content.Security.Policy/i.test(problem)), problems.join('\n'));
  await page.close();
}

/** Waits until a value that a function reads in the page fulfils a condition, and returns it. */
async function until(page, read, condition, what) {
  for (const start = Date.now(); ; await settle(page)) {
    const value = await read(page);
    if (condition(value)) return value;
    assert.ok(Date.now() - start < 30000, `${what}: ${value}`);
  }
}

const isPlaying = (page) => page.$eval('#play', (button) => button.getAttribute('aria-pressed') === 'true');
const height = async (page) => Number.parseFloat((await text(page, '#selection')).split(',').pop());
const slider = (page) => page.$eval('#plots label', (row) => [row.classList.contains('held'), Number(row.querySelector('output').textContent)]);

async function testLive(browser, name) {
  const { page, problems } = await open(browser, 'live.url', { width: 1280, height: 720 });
  const reset = async () => {
    await page.keyboard.press('r');
    await until(page, time, (now) => now === 0, 'a reset restores the time');
  };
  if (!(await isPlaying(page))) await page.keyboard.press(' ');
  await until(page, time, (now) => now > 0.2, 'the simulation runs');
  await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => !playing, 'the space bar pauses');
  const paused = await time(page);
  const moved = await canvas(page);
  await settle(page);
  await settle(page);
  assert.equal(await time(page), paused, 'a pause lasts');
  for (let i = 0; i < 9; i++) await page.click('#advance');
  await page.keyboard.press('ArrowRight');
  // The time has two decimals, and a step takes 5 ms.
  const after = await until(page, time, (now) => now > paused + 0.03, 'steps advance');
  assert.ok(after <= paused + 0.06, `ten steps: ${paused} to ${after}`);
  await reset();
  assert.equal(await isPlaying(page), false, 'a reset keeps the pause');
  await settle(page);
  const standing = await canvas(page);
  assert.ok(difference(moved, standing) > 0.5, 'a reset changes the picture');

  await page.focus('#plots input');
  await page.keyboard.press('End');
  await until(page, slider, ([held, value]) => held && value === 1, 'a slider holds its control');
  await page.click('#plots button');
  await until(page, slider, ([held]) => !held, 'the button releases it');

  const box = await (await page.$('#canvas')).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.click('#pull');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 100, y, { steps: 4 });
  await until(page, canvas, (picture) => difference(standing, picture) > 0.5, 'while paused, a pull moves the body');
  await page.screenshot({ path: join(folder, `${name}-live-dragged.png`) });
  await page.mouse.up();
  await page.click('#pull');
  assert.equal(await time(page), 0);
  await reset();
  await page.keyboard.press('Escape');
  await until(page, canvas, (picture) => difference(standing, picture) < 0.1, 'a reset moves it back');
  await page.mouse.click(x, y);
  const start = await until(page, height, Number.isFinite, 'the pulled body is selected');
  await page.keyboard.down('Control');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y - 250, { steps: 4 });
  await page.evaluate(() => document.getElementById('play').click());
  await until(page, height, (now) => now > start + 0.1, 'a pull lifts the body');
  await page.screenshot({ path: join(folder, `${name}-live-pulled.png`) });
  await page.mouse.up();
  await page.keyboard.up('Control');
  await until(page, height, (now) => now < start, 'a released body falls');

  // Another page sees the same simulation, and an empty page, of another origin, cannot connect.
  await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => !playing, 'the space bar pauses');
  const other = await open(browser, 'live.url', { width: 390, height: 844, scale: 2 });
  const shown = await time(page);
  await until(other.page, time, (now) => now === shown, 'two pages show one simulation');
  await other.page.keyboard.press(' ');
  await until(other.page, isPlaying, (playing) => playing, 'the other page resumes');
  await other.page.close();
  await page.bringToFront();
  await until(page, isPlaying, (playing) => playing, 'both pages show it');
  // While the simulation runs, a slow browser can miss the states before this time.
  await page.keyboard.press(' ');
  await until(page, isPlaying, (playing) => !playing, 'the page pauses again');
  assert.ok((await time(page)) >= shown);
  await page.keyboard.press('r');
  await until(page, time, (now) => now === 0, 'a reset restores the time');
  assert.deepEqual(problems, []);
  await page.close();
  const blank = await browser.newPage();
  const address = `${readFileSync(join(folder, 'live.url'), 'utf8').replace('http', 'ws')}/live`;
  const connect = (url) =>
    new Promise((done) => {
      const socket = new WebSocket(url);
      socket.onopen = () => done('open');
      socket.onerror = () => done('refused');
    });
  assert.equal(await blank.evaluate(connect, address), 'refused');
  await blank.close();
}

/** The servers end. */
async function testEnd(browser, name) {
  const { page } = await open(browser, 'live.url', { width: 1280, height: 720 });
  writeFileSync(join(folder, 'stop'), '');
  await page.waitForFunction(() => document.documentElement.dataset.live === 'lost', { timeout: 60000 });
  assert.match(await text(page, '#note'), /No connection/);
  await page.screenshot({ path: join(folder, `${name}-live-lost.png`) });
  await page.close();
}

async function testHostileLive(browser) {
  const { page, problems } = await open(browser, 'hostile.url', { width: 1280, height: 720 });
  const box = await (await page.$('#canvas')).boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await settle(page);
  assert.equal(await page.evaluate(() => globalThis.hacked), undefined);
  assert.equal(await page.$$eval('img, [onerror]', (found) => found.length), 0);
  for (const selector of ['#plots', '#selection']) assert.match(await text(page, selector), /<img src=x/);
  assert.match(await text(page, '#title'), /<script>/);
  assert.deepEqual(problems, []);
  await page.close();
}

async function takeScreenshots(browser, name) {
  const sizes = { phone: { width: 390, height: 844, scale: 2, touch: true } };
  if (process.env.LOOK) sizes.laptop = { width: 1440, height: 900 };
  for (const file of ['humanoid', 'ghosts', 'rollouts', 'robot', 'soft', 'hostile', 'live.url', 'batch.url', 'soft.url', 'hostile.url']) {
    const [served, shown] = [file.endsWith('.url'), file.replace('.url', '-live')];
    for (const [size, options] of Object.entries(sizes)) {
      // WebDriver BiDi of Firefox cannot select a colour scheme or a touch screen.
      const dark = file === 'ghosts' && name === 'chromium';
      const { page, problems } = await open(browser, served ? file : `${file}.html`, { ...options, dark, hash: '#t=0.6' });
      await settle(page);
      assert.ok(contrast(await canvas(page)) > 5, `${file} has a picture`);
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(overflow <= 0, `${file} fits into ${options.width} pixels`);
      await page.screenshot({ path: join(folder, `${name}-${shown}-${size}.png`) });
      if (options.touch && ['live.url', 'hostile.url'].includes(file)) {
        await page.click('#show');
        await settle(page);
        await page.screenshot({ path: join(folder, `${name}-${shown}-${size}-controls.png`) });
      }
      if (options.touch && name === 'chromium' && !served) {
        await page.tap('#play');
        await page.waitForFunction(() => Number.parseFloat(document.getElementById('time').textContent) !== 0.6);
      }
      assert.deepEqual(problems, []);
      await page.close();
    }
  }
}

for (const [name, options] of Object.entries(BROWSERS)) {
  if (only && only !== name) continue;
  const browser = await launch({ headless: true, ...options });
  try {
    if (process.env.LOOK) await printFirstPictures(browser, name);
    await testControls(browser, name);
    console.log(`${name}: controls`);
    for (const model of Object.keys(TOLERANCES)) {
      const value = await testPicture(browser, name, model);
      console.log(`${name}: ${model} differs from the renderer by ${value.toFixed(2)} of 255`);
    }
    await testSeveral(browser, name);
    console.log(`${name}: 64 rollouts, a picture in ${(await testMany(browser)).toFixed(0)} ms`);
    await testBatch(browser, name);
    await testHostile(browser);
    await testHostileLive(browser);
    console.log(`${name}: hostile names run no script`);
    const value = await testSoftLive(browser);
    console.log(`${name}: the live skin and tendon differ from the recorded ones by ${value.toFixed(3)} of 255`);
    await testLive(browser, name);
    console.log(`${name}: live page`);
    await takeScreenshots(browser, name);
    console.log(`${name}: screenshots`);
    if (only || name === Object.keys(BROWSERS).at(-1)) await testEnd(browser, name);
  } finally {
    await browser.close();
  }
}
