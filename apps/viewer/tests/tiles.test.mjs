// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A scan as 3D Tiles: the page loads what is seen, finer where the viewer is near, within a memory.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { foreignRequests, openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { run, serve } from './support/pcavr.mjs';

const limit = { timeout: 200_000 };
const slack = 1.5; // [MB] of a tile that is loaded as the memory gets full

let folder;
let server;
let browser;
let tiles; // files of the export

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pcavr-browser-tiles-'));
  const [recording, scene, tiled] = ['recording', 'scene', 'tiles'].map((n) => join(folder, n));
  run('simulate', 'room', '--seed', '1', '-o', recording);
  run('build', recording, '--voxel', '0.005', '-o', scene);
  run('export', scene, '--to', '3dtiles', '-o', tiled);
  tiles = readdirSync(join(tiled, 'tiles')).filter((name) => name !== 'bodies.glb').length;
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
  assert.ok(fetched.every((url) => !url.endsWith('bodies.glb')), 'bodies are drawn by the page');
  await page.close();
});

test('a walk through the scene keeps within the memory', limit, async (t) => {
  const memory = 6; // [MB]
  const { page, seen } = await openPage(
    browser.context,
    `${server.url}?tile-megabytes=${memory}`,
  );
  await settled(page);
  await page.click('#navigation-walk, [name=navigation][value=walk]', { force: true });
  await page.focus('canvas');
  let most = { megabytes: 0 };
  for (const key of ['w', 'j', 'w', 'j', 'w', 'l', 'w', 'j', 'w', 'j']) {
    await page.keyboard.down(key);
    for (let i = 0; i < 10; ++i) {
      await page.waitForTimeout(100);
      const stats = await statsOf(page);
      if (stats.megabytes > most.megabytes) most = stats;
    }
    await page.keyboard.up(key);
  }
  await screenshot(page, 'tiles-walk');
  const fetched = seen.requests.filter((url) => /\/tiles\/tiles\/.*\.glb$/.test(url));
  t.diagnostic(`at most ${JSON.stringify(most)}; ${fetched.length} requests of tiles`);
  assert.ok(most.megabytes > 0.3 * memory, 'the memory is used');
  assert.ok(most.megabytes < memory + slack, `${most.megabytes} MB are loaded`);
  assert.deepEqual(seen.errors, []);
  await page.close();
});
