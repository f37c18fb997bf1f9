// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a headset that draws 72 frames a second can draw, with a scanned scene.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { enterVr } from './support/headset.mjs';
import { setStage } from './support/stage.mjs';

const limit = { timeout: 120_000 };
const maxCalls = 60; // by eye
const maxTriangles = 300_000;
const maxTextureBytes = 16 * 1024 * 1024;
const maxScanBytes = (2048 * 1024 * 4 * 4) / 3; // texture.atlas_width, texture.atlas_height

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
    const bytes = [...textures].map(
      ({ image, generateMipmaps }) =>
        image.width * image.height * 4 * (generateMipmaps ? 4 / 3 : 1),
    );
    const scanBytes = Math.max(...bytes);
    const otherBytes = bytes.reduce((sum, value) => sum + value, 0) - scanBytes;
    const { calls, triangles } = app.renderer.info.render;
    return { calls, triangles, scanBytes, otherBytes };
  });
}

test('a frame of a scanned scene is within the budget of a headset', limit, async (t) => {
  const { page } = await stage.open(`${stage.server.url}?triangles=280000`);
  await loaded(page);
  const flat = await drawn(page);
  t.diagnostic(`page: ${JSON.stringify(flat)}`);
  assert.ok(flat.triangles > 10_000, 'the scan is drawn');
  assert.ok(flat.scanBytes > 1e6, 'the scan has its texture');
  assert.ok(flat.calls <= maxCalls, `${flat.calls} draw calls`);
  assert.ok(flat.triangles <= maxTriangles, `${flat.triangles} triangles`);
  await page.close();

  const opened = await enterVr(stage);
  await loaded(opened.page);
  const both = await drawn(opened.page);
  t.diagnostic(`headset, both eyes: ${JSON.stringify(both)}`);
  assert.ok(both.calls <= 2 * maxCalls, `${both.calls} draw calls`);
  assert.ok(both.scanBytes <= maxScanBytes, `${both.scanBytes} bytes of the scan's texture`);
  const bytes = maxScanBytes + both.otherBytes;
  assert.ok(bytes <= maxTextureBytes, `up to ${bytes} bytes of textures`);
  await screenshot(opened.page, 'vr-textured');
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
  assert.deepEqual(seen.errors, []);
});
