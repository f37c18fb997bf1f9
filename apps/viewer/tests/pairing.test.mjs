// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { get } from 'node:https';
import { networkInterfaces } from 'node:os';
import { test } from 'node:test';
import { picture } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { Live } from './support/live.mjs';
import { limit as longest, ofScene, setStage } from './support/stage.mjs';

// Who asks from this machine's own loopback address needs no code: another address is needed.
const address = Object.values(networkInterfaces())
  .flat()
  .find(({ family, internal }) => family === 'IPv4' && !internal)?.address;
const skip = address ? false : 'this machine has no address but loopback';
const limit = { ...longest, skip };

const stage = setStage({ words: (scene) => [...ofScene(scene), '--host', address, '--tls'], skip });

function statusOf(path) {
  return new Promise((resolve, reject) => {
    get(new URL(path, stage.server.url), { rejectUnauthorized: false }, (response) => {
      response.resume();
      resolve(response.statusCode);
    }).on('error', reject);
  });
}

test('who is not paired gets the page, and nothing of the scene', limit, async () => {
  assert.match(stage.server.code, /^[A-Z0-9]{6}$/);
  assert.equal(await statusOf('/'), 200);
  assert.equal(await statusOf('/api/session'), 200);
  for (const path of [
    '/api/scene.json',
    '/scene/scene.glb',
    '/api/replay.bin',
    '/api/frames/0.jpg',
  ])
    assert.equal(await statusOf(path), 401, path);
  const stranger = new Live(stage.server.url);
  assert.equal(await stranger.ended, 401);
  assert.equal(stranger.state, null);
});

test('a wrong code gets nothing, the right one gets in', limit, async () => {
  const { page, seen } = await stage.open();
  await page.locator('#pairing[open]').waitFor();
  await picture(page, 'pairing');
  const wrong = stage.server.code.replace(/^./, (c) => (c === 'A' ? 'B' : 'A'));
  await page.fill('#pairing-code', wrong);
  await page.click('#pairing-form button');
  await page.locator('#pairing-error', { hasText: 'not the code' }).waitFor();
  assert.equal(await page.evaluate(() => window.__pcavr), undefined);
  assert.ok(!seen.requests.some((r) => /scene|live/.test(new URL(r).pathname)));
  await page.fill('#pairing-code', stage.server.code);
  await page.click('#pairing-form button');
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
});

test(
  'a code is not to be guessed: after a few tries the server stops listening',
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
