// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The rules of axe-core on the page and on a report, at five sizes, and dark.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, screenshot } from './support/browser.mjs';
import { loaded, openPanel } from './support/drawn.mjs';
import { serve } from './support/pcavr.mjs';
import { sample, writeReport } from './support/report_sample.mjs';
import { sceneArguments, setStage } from './support/stage.mjs';

const limit = { timeout: 180_000 }; // [ms]
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const sizes = [
  [360, 640],
  [390, 844],
  [820, 1180],
  [1280, 800],
  [1920, 1080],
];

const stage = setStage();
let report;
before(() => (report = writeReport(sample)));
after(() => report.remove());

/// Each violation with the elements that have it.
async function violations(page) {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => (await window.axe.run()).violations);
  return found.map(
    ({ id, nodes }) => `${id}: ${nodes.map((n) => n.html.slice(0, 120)).join(' | ')}`,
  );
}

/// Runs `look` at each size, and in the dark scheme at one: colours do not depend on the size.
async function everywhere(page, look) {
  const all = [];
  for (const [width, height, colorScheme] of [...sizes, [1280, 800, 'dark']]) {
    await page.emulateMedia({ colorScheme: colorScheme ?? 'light' });
    await page.setViewportSize({ width, height });
    await look();
    // The picture takes the new size with the next frame.
    const fits = await page
      .waitForFunction(() => document.documentElement.scrollWidth <= innerWidth, null, {
        timeout: 5000,
      })
      .catch(() => null);
    if (!fits) all.push(`${width}: does not fit the window's width`);
    const found = await violations(page);
    all.push(...found.map((one) => `${colorScheme ?? 'light'} ${width}: ${one}`));
  }
  return all;
}

test('the page, with its panel and its keys, violates no rule', limit, async () => {
  const { page } = await stage.open();
  await loaded(page);
  const found = await everywhere(page, () => openPanel(page));
  await page.locator('#show-shortcuts').click();
  found.push(...(await violations(page)));
  await screenshot(page, 'accessible-keys');
  assert.deepEqual(found, []);
});

test('a replay with its plots violates no rule', limit, async () => {
  const { recording } = stage.scene;
  const tracked = ['--tracked', join(recording, 'tracked')];
  const server = await serve(...sceneArguments(stage.scene), '--replay', recording, ...tracked);
  try {
    const { page } = await stage.open(server.url);
    await page.waitForFunction(() => window.__pcavr?.replay && window.__pcavr.scene.isComplete);
    await page.getByRole('button', { name: 'Next event' }).click();
    const found = await everywhere(page, () => openPanel(page));
    await screenshot(page, 'accessible-replay-dark');
    assert.deepEqual(found, []);
  } finally {
    await server.stop();
  }
});

test('a report violates no rule', limit, async () => {
  const { page } = await openPage(stage.browser.context, report.url);
  await page.locator('footer').waitFor();
  assert.deepEqual(await everywhere(page, () => page.waitForTimeout(100)), []);
});
