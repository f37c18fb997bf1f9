// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { elsewhere, openBrowser, openPage, picture } from './support/browser.mjs';
import { loaded, openPanel } from './support/drawn.mjs';
import { makeScene, serve } from './support/pcavr.mjs';

const limit = { timeout: 60_000 }; // [ms]

let browser, scene, server;

before(async () => {
  scene = makeScene();
  server = await serve(scene.scene, '--parameters', scene.parameters);
  browser = await openBrowser();
}, limit);

afterEach(() => browser?.closePages());

after(async () => {
  await browser?.close();
  await server?.stop();
  scene?.remove();
});

test('the page loads from this server alone, and without an error', limit, async () => {
  const { page, seen } = await openPage(browser.context, server.url);
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  assert.deepEqual(elsewhere(seen.requests, server.url), []);
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
  'each layer switches on and off, and light and dark are pictures of their own',
  limit,
  async () => {
    const { page, seen } = await openPage(browser.context, server.url);
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
      await picture(page, `page-${colorScheme}`);
    }
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

test('a file that the scene lacks is named, and the rest is shown', limit, async () => {
  const page = await browser.context.newPage();
  const { objects } = await (await fetch(`${server.url}api/scene.json`)).json();
  await page.route(`**${objects[0].path}`, (route) => route.fulfill({ status: 404 }));
  await page.goto(server.url);
  await page.locator('#toasts', { hasText: objects[0].path }).waitFor();
  const { objectsLoaded } = await page.evaluate(() => window.__pcavr.scene);
  assert.equal(objectsLoaded, objects.length - 1);
});
