// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a headset that draws 72 frames a second can draw, with a scanned scene.
import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { enterVr } from './support/headset.mjs';
import { multiplyBodies } from './support/many_bodies.mjs';
import { serve } from './support/pcavr.mjs';
import { setStage } from './support/stage.mjs';

const limit = { timeout: 120_000 };
const maxCalls = 60; // by eye
const maxTriangles = 300_000;
const maxTextureBytes = 16 * 1024 * 1024;
// texture.atlas_width, texture.atlas_height: of the scan and all bodies together
const maxSceneBytes = (2048 * 1024 * 4 * 4) / 3;

// PCAVR_BROWSER_SCENE: the folder of another scene to measure.
const other = process.env.PCAVR_BROWSER_SCENE;
const stage = setStage({
  headset: true,
  images: ['--frames-per-second', '4', '--duration', '6'],
  serverArguments: ({ scene }) => [other ?? scene],
});

/// Of the last frame drawn, both eyes in a headset.
function drawn(page) {
  return page.evaluate(() => {
    const { app } = window.__pcavr;
    const textures = new Set();
    app.scene.traverse(({ material }) => {
      for (const { map } of material ? [material].flat() : []) if (map) textures.add(map);
    });
    const bytesOf = (isOfScene) =>
      [...textures]
        .filter(({ image }) => image instanceof ImageBitmap === isOfScene)
        .map(
          ({ image, generateMipmaps }) =>
            image.width * image.height * 4 * (generateMipmaps ? 4 / 3 : 1),
        )
        .reduce((sum, value) => sum + value, 0);
    const { calls, triangles } = app.renderer.info.render;
    // Of the scan and the bodies, which are pictures, and of what the page draws itself.
    return { calls, triangles, sceneBytes: bytesOf(true), pageBytes: bytesOf(false) };
  });
}

test('a frame of a scanned scene is within the budget of a headset', limit, async (t) => {
  const { page } = await stage.open(`${stage.server.url}?triangles=280000`);
  await loaded(page);
  const flat = await drawn(page);
  t.diagnostic(`page: ${JSON.stringify(flat)}`);
  assert.ok(flat.triangles > 10_000, 'the scan is drawn');
  assert.ok(flat.sceneBytes > 1e6, 'the scan has its texture');
  assert.ok(flat.calls <= maxCalls, `${flat.calls} draw calls`);
  assert.ok(flat.triangles <= maxTriangles, `${flat.triangles} triangles`);
  await page.close();

  const opened = await enterVr(stage);
  await loaded(opened.page);
  const both = await drawn(opened.page);
  t.diagnostic(`headset, both eyes: ${JSON.stringify(both)}`);
  assert.ok(both.calls <= 2 * maxCalls, `${both.calls} draw calls`);
  assert.ok(both.sceneBytes <= maxSceneBytes, `${both.sceneBytes} bytes of the scene's textures`);
  const bytes = maxSceneBytes + both.pageBytes;
  assert.ok(bytes <= maxTextureBytes, `up to ${bytes} bytes of textures`);
  await screenshot(opened.page, 'vr-textured');
});

test('forty bodies with their tags are shown, within the memory of a headset', limit, async () => {
  const many = join(stage.scene.folder, 'many');
  cpSync(stage.scene.scene, many, { recursive: true });
  multiplyBodies(many, 40);
  const server = await serve(many);
  try {
    const open = () => openPage(stage.browser.context, server.url);
    const { page, seen } = await enterVr({ open });
    await loaded(page);
    assert.equal(await page.evaluate(() => window.__pcavr.summary().scene.objectsLoaded), 40);
    const { tags } = await (await fetch(`${server.url}api/scene.json`)).json();
    assert.ok(tags.length >= 80, `${tags.length} tags`);
    // The copies have a texture each, in place of a share: what a built scene has at most is known.
    const bytes = maxSceneBytes + (await drawn(page)).pageBytes;
    assert.ok(bytes <= maxTextureBytes, `up to ${bytes} bytes of textures`);
    assert.deepEqual(seen.errors, []);
  } finally {
    await server.stop();
  }
});

test('a scanned scene at five sizes in both themes', limit, async () => {
  const { page, seen } = await stage.open();
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    for (const [width, height] of [
      [1920, 1080],
      [1280, 800],
      [1024, 768],
      [768, 1024],
      [390, 844],
    ]) {
      await page.setViewportSize({ width, height });
      await loaded(page);
      await page.waitForTimeout(300); // some frames after the last change of size
      // Nothing is cut off at the right, nor taller than the window.
      const whole = await page.evaluate(() => {
        const { scrollWidth, scrollHeight } = document.documentElement;
        return [scrollWidth, scrollHeight];
      });
      assert.deepEqual(whole, [width, height]);
      await screenshot(page, `scan-${colorScheme}-${width}x${height}`);
    }
  }
  await page.setViewportSize({ width: 1, height: 1 });
  await page.waitForTimeout(300);
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.waitForTimeout(300);
  assert.ok((await drawn(page)).triangles > 10_000, 'drawn again after a window of 1 px');
  assert.deepEqual(seen.errors, []);
});
