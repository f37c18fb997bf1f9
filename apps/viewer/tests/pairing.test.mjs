// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { get } from 'node:https';
import { networkInterfaces } from 'node:os';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { Live } from './support/live.mjs';
import { limit as timeLimit, sceneArguments, setStage } from './support/stage.mjs';

// Loopback clients need no pairing code: the test needs another address.
const address = Object.values(networkInterfaces())
  .flat()
  .find(({ family, internal }) => family === 'IPv4' && !internal)?.address;
const skip = address ? false : 'this machine has no address except loopback';
const limit = { ...timeLimit, skip };

const stage = setStage({
  serverArguments: (scene) => [...sceneArguments(scene), '--host', address, '--tls'],
  skip,
});

function statusOf(path) {
  return new Promise((resolve, reject) => {
    get(new URL(path, stage.server.url), { rejectUnauthorized: false }, (response) => {
      response.resume();
      resolve(response.statusCode);
    }).on('error', reject);
  });
}

test('an unpaired client gets the page, but nothing of the scene', limit, async () => {
  assert.match(stage.server.code, /^[A-Z0-9]{6}$/);
  assert.equal(await statusOf('/'), 200);
  assert.equal(await statusOf('/api/session'), 200);
  for (const path of [
    '/api/scene.json',
    '/scene/scene.glb',
    '/api/replay.bin',
    '/api/frames/0.jpg',
    '/api/code.svg',
  ])
    assert.equal(await statusOf(path), 401, path);
  const unpaired = new Live(stage.server.url);
  assert.equal(await unpaired.ended, 401);
  assert.equal(unpaired.state, null);
});

test('a wrong code is rejected, the right one pairs the page', limit, async () => {
  const { page, seen } = await stage.open();
  await page.locator('#pairing[open]').waitFor();
  await screenshot(page, 'pairing');
  const wrong = stage.server.code.replace(/^./, (c) => (c === 'A' ? 'B' : 'A'));
  await page.fill('#pairing-code', wrong);
  await page.click('#pairing-form button');
  await page.locator('#pairing-error', { hasText: 'Wrong code' }).waitFor();
  assert.equal(await page.evaluate(() => window.__pcavr), undefined);
  assert.ok(!seen.requests.some((r) => /scene|live/.test(new URL(r).pathname)));
  await page.fill('#pairing-code', stage.server.code);
  await page.click('#pairing-form button');
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
});

test('the address of the QR code pairs, and the code leaves it', limit, async () => {
  const { page } = await stage.open();
  await page.context().clearCookies();
  await page.goto(`${stage.server.url}#code=${stage.server.code}`);
  await page.reload(); // a change of the fragment alone loads nothing
  await loaded(page);
  assert.equal(await page.locator('#pairing[open]').count(), 0);
  assert.doesNotMatch(page.url(), /code/);
});

test('a paired page shows the code for another device', limit, async () => {
  const { page, seen } = await stage.open();
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  await page.click('#other-device summary');
  await page.waitForFunction(() => document.querySelector('#other-device img').naturalWidth > 0);
  await screenshot(page, 'other-device');
  assert.deepEqual(seen.errors, []);
});

test(
  'pairing attempts are rate-limited, so that a pairing code cannot be guessed',
  limit,
  async () => {
    const { page } = await stage.open();
    await page.context().clearCookies();
    const statuses = await page.evaluate(async () => {
      const answers = [];
      for (let i = 0; i < 8; ++i) {
        const answer = await fetch('/api/pair', {
          method: 'POST',
          headers: { 'content-type': 'application/json' },
          body: JSON.stringify({ code: `AAAAA${i}` }),
        });
        answers.push(answer.status);
      }
      return answers;
    });
    assert.equal(statuses.at(-1), 429);
    assert.ok(!statuses.includes(200));
    await page.close();
  },
);
