// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A scan as 3D Tiles: the page loads what is seen, finer where the viewer is near, within a memory.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { foreignRequests, openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { run, serve } from './support/pcavr.mjs';

const limit = { timeout: 200_000 };

let folder;
let server;
let browser;
let tiles; // number of the export's
let largest; // of them [MB]

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pcavr-browser-tiles-'));
  const [recording, scene, tiled] = ['recording', 'scene', 'tiles'].map((n) => join(folder, n));
  run('simulate', 'room', '--seed', '1', '--frames-per-second', '3', '-o', recording);
  run('build', recording, '--voxel', '0.005', '-o', scene);
  run('export', scene, '--to', '3dtiles', '-o', tiled);
  const files = readdirSync(join(tiled, 'tiles')).filter((name) => name !== 'bodies.glb');
  tiles = files.length;
  largest = Math.max(...files.map((name) => statSync(join(tiled, 'tiles', name)).size)) / 1e6;
  server = await serve(scene, '--tiles', tiled);
  browser = await openBrowser();
}, limit);

after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

const statsOf = (page) => page.evaluate(() => window.__pcavr.tiles.stats);

/// Waits until nothing is being loaded, and returns what is drawn.
async function settled(page) {
  await loaded(page);
  await page.waitForFunction(() => {
    const { stats } = window.__pcavr.tiles;
    window.quiet = stats.isComplete && stats.visible > 0 ? (window.quiet ?? 0) + 1 : 0;
    return window.quiet > 20; // frames
  });
  return statsOf(page);
}

/// Moves nearer to what is drawn in the middle, by the mouse's wheel.
async function moveNearer(page, steps) {
  await page.mouse.move(240, 160);
  for (let i = 0; i < steps; ++i) {
    await page.mouse.wheel(0, -120);
    await page.waitForTimeout(60);
  }
}

test('finer tiles are loaded where the viewer is near', limit, async (t) => {
  const { page, seen } = await openPage(browser.context, server.url);
  const far = await settled(page);
  await screenshot(page, 'tiles-far');
  assert.ok(far.loaded < tiles, `${far.loaded} of ${tiles} tiles are loaded`);
  await moveNearer(page, 14);
  const near = await settled(page);
  await screenshot(page, 'tiles-near');
  t.diagnostic(`of ${tiles} tiles, far: ${JSON.stringify(far)}, near: ${JSON.stringify(near)}`);
  assert.ok(near.depth > far.depth, `depth ${far.depth}, then ${near.depth}`);
  assert.ok(near.loaded < tiles, 'what is not seen is not loaded');
  assert.deepEqual(seen.errors, []);
  assert.deepEqual(foreignRequests(seen.requests, server.url), []);
  const fetched = seen.requests.filter((url) => url.endsWith('.glb') && url.includes('/tiles/'));
  assert.ok(
    fetched.every((url) => !url.endsWith('bodies.glb')),
    'bodies are drawn by the page',
  );
  await page.close();
});

test('tiles keep within the memory, and those out of use are dropped', limit, async (t) => {
  const memory = 8; // [MB]
  const { page, seen } = await openPage(browser.context, `${server.url}?tile-megabytes=${memory}`);
  await settled(page);
  let most = { megabytes: 0 };
  const views = [];
  for (let i = 0; i < 4; ++i) {
    await moveNearer(page, 7);
    await page.mouse.down();
    await page.mouse.move(440, 170, { steps: 10 }); // turns the scene
    await page.mouse.up();
    for (let k = 0; k < 10; ++k) {
      await page.waitForTimeout(100);
      views.push(await statsOf(page));
      if (views.at(-1).megabytes > most.megabytes) most = views.at(-1);
    }
  }
  await screenshot(page, 'tiles-within-memory');
  const fetched = seen.requests.filter((url) => /\/tiles\/tiles\/.*\.glb$/.test(url));
  t.diagnostic(`at most ${JSON.stringify(most)}; ${fetched.length} requests of tiles`);
  assert.ok(most.megabytes > 0.5 * memory, 'the memory is used');
  assert.ok(most.megabytes < memory + 2 * largest, `${most.megabytes} MB are loaded`);
  assert.ok(
    views.every(({ visible }) => visible > 0),
    'there is always something to see',
  );
  assert.ok(fetched.length > most.loaded, 'tiles were dropped');
  assert.deepEqual(seen.errors, []);
  await page.close();
});
