// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { foreignRequests, screenshot } from './support/browser.mjs';
import { loaded, openPanel } from './support/drawn.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const stage = setStage();

test('the page loads from this server only, without errors', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  assert.deepEqual(foreignRequests(seen.requests, stage.server.url), []);
  assert.ok(seen.requests.some((r) => r.includes('/api/scene.json')));
  assert.deepEqual(seen.errors, []);
  const { scene: shown, bodies } = await page.evaluate(() => window.__pcavr.summary());
  assert.deepEqual(shown.failures, []);
  assert.equal(shown.objectsLoaded, 2);
  assert.deepEqual(
    bodies.map((body) => body.name),
    ['box_1', 'box_2'],
  );
});

test(
  'each layer can be shown and hidden by its checkbox, and both themes apply',
  limit,
  async () => {
    const { page, seen } = await stage.open();
    await loaded(page);
    await openPanel(page);
    const names = await page.evaluate(() => Object.keys(window.__pcavr.layers));
    let switched = 0;
    for (const name of names) {
      const box = page.locator(`#layer-${name}`);
      if (await box.isDisabled()) continue;
      const before = await box.isChecked();
      await box.click();
      assert.equal(await page.evaluate((n) => window.__pcavr.layers[n], name), !before, name);
      await box.click();
      assert.equal(await page.evaluate((n) => window.__pcavr.layers[n], name), before, name);
      ++switched;
    }
    assert.ok(switched >= 4, `${switched} layers could be switched`);
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      await page.waitForFunction((t) => document.documentElement.dataset.theme === t, colorScheme);
      await screenshot(page, `page-${colorScheme}`);
    }
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

test('the keyboard alone reaches the scene, turns it, and walks', limit, async () => {
  const { page } = await stage.open();
  await loaded(page);
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'view');
  const cameraPosition = () => page.evaluate(() => window.__pcavr.app.camera.position.toArray());
  for (const key of ['j', 'i', 'w']) {
    const before = await cameraPosition();
    await page.keyboard.down(key);
    const hasMoved = async () => distance(await cameraPosition(), before) > 0.01;
    await until(hasMoved, `${key} moves the camera`);
    await page.keyboard.up(key);
  }
});

test('without a scan the support planes are shown', limit, async () => {
  const { page } = await stage.open();
  await loaded(page);
  assert.equal(await page.evaluate(() => window.__pcavr.layers.planes), true);
  assert.equal(await page.locator('#layer-planes').isChecked(), true);
});

test(
  'a selected level of detail is shown once it is loaded, and the progress ends',
  limit,
  async () => {
    const page = await stage.browser.context.newPage();
    const scene = await (await fetch(`${stage.server.url}api/scene.json`)).json();
    const [fine, coarse] = scene.objects.map(({ path, bytes }) => ({ path, bytes, triangles: 12 }));
    scene.mesh = [{ ...fine, triangles: 1e9 }, coarse];
    await page.route('**/api/scene.json', (route) => route.fulfill({ json: scene }));
    await page.goto(stage.server.url);
    await loaded(page);
    await openPanel(page);
    assert.equal(await page.evaluate(() => window.__pcavr.scene.level), 1);
    await page.selectOption('#detail', '0');
    await page.waitForFunction(() => window.__pcavr.scene.level === 0);
    await page.locator('#progress.done').waitFor({ state: 'attached' });
    assert.equal(await page.locator('#loading-text').textContent(), '');
    // Of two selections the later is shown, whichever file arrives first.
    await page.route(`**${coarse.path}`, async (route) => {
      await new Promise((resolve) => setTimeout(resolve, 500));
      await route.continue();
    });
    const late = page.waitForResponse(`**${coarse.path}`);
    await page.selectOption('#detail', '1');
    await page.selectOption('#detail', '0');
    await (await late).finished();
    await page.waitForTimeout(200);
    assert.equal(await page.evaluate(() => window.__pcavr.scene.level), 0);
  },
);

test('a scan without bodies is shown upright, and says what can be done', limit, async () => {
  const page = await stage.browser.context.newPage();
  const scene = await (await fetch(`${stage.server.url}api/scene.json`)).json();
  // A world frame like a camera's: y down; a camera that looks along its z.
  const camera = { position: [0, 0, 0], quaternion: [0, 0, 0, 1] };
  const mesh = scene.objects.map(({ path, bytes }) => ({ path, bytes, triangles: 12 }));
  Object.assign(scene, { mesh, objects: [], tags: [], support_planes: [], cameras: [camera] });
  scene.up = [0, -1, 0];
  await page.route('**/api/scene.json', (route) => route.fulfill({ json: scene }));
  await page.goto(stage.server.url);
  await loaded(page);
  const { up, right } = await page.evaluate(() => {
    const { app } = window.__pcavr;
    const direction = (x, y, z) =>
      app.camera.position
        .clone()
        .set(x, y, z)
        .transformDirection(app.base.matrixWorld)
        .transformDirection(app.camera.matrixWorldInverse)
        .toArray();
    return { up: direction(0, -1, 0), right: direction(1, 0, 0) };
  });
  assert.ok(distance(up, [0, 1, 0]) < 1e-6, `up is drawn along ${up}`);
  assert.ok(distance(right, [1, 0, 0]) < 1e-6, `right is drawn along ${right}`);
  await openPanel(page);
  assert.match(await page.locator('#objects').innerText(), /nothing here can be pushed/);
  assert.match(await page.locator('#call-to-action').textContent(), /touch the scan/);
  assert.equal(await page.locator('#labels .robot').count(), 0);
});

test('a missing file of the scene is named, and the rest is shown', limit, async () => {
  const page = await stage.browser.context.newPage();
  const { objects } = await (await fetch(`${stage.server.url}api/scene.json`)).json();
  await page.route(`**${objects[0].path}`, (route) => route.fulfill({ status: 404 }));
  await page.goto(stage.server.url);
  await page.locator('#toasts', { hasText: objects[0].path }).waitFor();
  // The toast appears at once, while other files may still be loading.
  await page.waitForFunction(() => window.__pcavr.scene.isComplete);
  const { objectsLoaded } = await page.evaluate(() => window.__pcavr.scene);
  assert.equal(objectsLoaded, objects.length - 1);
});

test(
  'occupied cells have a legend of heights, and points are as large as their spacing',
  limit,
  async () => {
    const page = await stage.browser.context.newPage();
    await page.setViewportSize({ width: 1280, height: 800 });
    const scene = await (await fetch(`${stage.server.url}api/scene.json`)).json();
    // A column of cells with an edge of 5 cm, and points 2 cm apart.
    const grid = (step, points, extra) => {
      const file = Buffer.alloc(20 + (6 + extra) * points.length);
      [0.4, 0, -0.1, step].forEach((value, i) => file.writeFloatLE(value, 4 * i));
      file.writeUInt32LE(points.length, 16);
      points.flat().forEach((value, i) => file.writeUInt16LE(value, 20 + 2 * i));
      return file;
    };
    const column = [0, 1, 2, 3].map((z) => [0, 0, z]);
    const points = [0, 1, 2, 3, 4].map((x) => [20 * x, 0, 0]);
    scene.occupancy = { path: '/scene/cells', cells: 4, edge: 0.05, bytes: 44 };
    scene.cloud = { path: '/scene/points', points: 5, bytes: 65 };
    await page.route('**/api/scene.json', (route) => route.fulfill({ json: scene }));
    await page.route('**/scene/cells', (route) => route.fulfill({ body: grid(0.05, column, 0) }));
    await page.route('**/scene/points', (route) => route.fulfill({ body: grid(0.001, points, 3) }));
    await page.goto(stage.server.url);
    await loaded(page);
    const legend = page.locator('#height-legend');
    assert.equal(await legend.isVisible(), false);
    await page.click('#layer-occupancy');
    await legend.locator('.ends', { hasText: '0.08 m' }).waitFor();
    assert.deepEqual(await legend.locator('.ends > span').allTextContents(), ['-0.08 m', '0.08 m']);
    await screenshot(page, 'page-cells');
    await page.click('#layer-occupancy');
    assert.equal(await legend.isVisible(), false);
    await page.click('#layer-cloud');
    const size = () =>
      page.evaluate(() => window.__pcavr.app.view.layers.group('cloud').children[0]?.material.size);
    await until(async () => Math.abs((await size()) - 0.03) < 1e-6, '1.5 times 2 cm');
  },
);

test('? shows all keys, and Escape closes them', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await page.locator('#view').focus();
  await page.keyboard.press('?');
  await page.locator('#shortcuts', { hasText: 'emergency stop' }).waitFor();
  await screenshot(page, 'shortcuts');
  await page.keyboard.press('Escape');
  await page.locator('#shortcuts').waitFor({ state: 'hidden' });
  await page.click('#show-shortcuts');
  await page.locator('#shortcuts').waitFor();
  assert.deepEqual(seen.errors, []);
});

test(
  'the scene is seen from above and from the front, and its picture is saved',
  limit,
  async () => {
    const { page, seen } = await stage.open();
    await loaded(page);
    await page.setViewportSize({ width: 1000, height: 600 });
    const elevation = () =>
      page.evaluate(() => {
        const { camera } = window.__pcavr.app;
        return Math.asin(-camera.getWorldDirection(camera.position.clone()).y);
      });
    await page.click('[data-side=top]');
    assert.ok((await elevation()) > 1.5, 'from above');
    await page.waitForTimeout(300);
    await screenshot(page, 'view-top');
    await page.click('[data-side=front]');
    assert.ok(Math.abs(await elevation()) < 0.1, 'from the front');
    await page.waitForTimeout(300);
    await screenshot(page, 'view-front');
    const saving = page.waitForEvent('download');
    await page.click('#save-picture');
    const picture = readFileSync(await (await saving).path());
    assert.equal(picture.toString('latin1', 1, 4), 'PNG');
    assert.ok(picture.length > 3000, `${picture.length} bytes: not an empty picture`);
    assert.deepEqual(seen.errors, []);
  },
);

test('the scene is seen as the camera of the recording saw it', limit, async () => {
  const page = await stage.browser.context.newPage();
  await page.setViewportSize({ width: 1000, height: 600 });
  const scene = await (await fetch(`${stage.server.url}api/scene.json`)).json();
  // It looks along y and down, at 45 degrees.
  const position = [0.1, -0.5, 0.6];
  const half = (3 * Math.PI) / 8;
  const quaternion = [-Math.sin(half), 0, 0, Math.cos(half)];
  const cameras = [{ position, quaternion }];
  await page.route('**/api/scene.json', (route) => route.fulfill({ json: { ...scene, cameras } }));
  await page.goto(stage.server.url);
  await loaded(page);
  await page.getByRole('button', { name: 'Camera', exact: true }).click();
  const seen = await page.evaluate(() => {
    const { camera, base } = window.__pcavr.app;
    const forward = camera.getWorldDirection(camera.position.clone());
    const ahead = base.worldToLocal(camera.position.clone().add(forward)).toArray();
    return { position: base.worldToLocal(camera.position.clone()).toArray(), ahead };
  });
  assert.ok(distance(seen.position, position) < 1e-6, `${seen.position}`);
  const ahead = [0.1, -0.5 + Math.SQRT1_2, 0.6 - Math.SQRT1_2];
  assert.ok(distance(seen.ahead, ahead) < 1e-6, `${seen.ahead}`);
});
