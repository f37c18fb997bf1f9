// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { loaded, openPanel } from './support/drawn.mjs';
import { Live, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';
import { between } from './support/relay.mjs';

const stage = setStage();

test('a page of another protocol is told so, and sent away', limit, async () => {
  const stranger = new Live(stage.server.url, { protocol: 2 });
  await stranger.ended;
  assert.equal(stranger.state, null);
  assert.ok(stranger.notices.some((n) => n.level === 'error' && /protocol/.test(n.text)));
});

test('a page that another server speaks to says so, and shows no state', limit, async (t) => {
  const relay = await between(stage.server.url, (message) => {
    // The version of every message from the server, as a later one would have it.
    message[4] = 2;
    return message;
  });
  t.after(relay.close);
  const { page } = await stage.open(relay.url);
  await page.locator('#toasts', { hasText: /version 2/ }).waitFor();
  assert.equal(await page.evaluate(() => window.__pcavr.connection), 'refused');
  assert.equal(await page.evaluate(() => window.__pcavr.state), null);
});

test('a page that lost its server finds it again', limit, async (t) => {
  const relay = await between(stage.server.url, (message) => message);
  t.after(relay.close);
  const { page } = await stage.open(relay.url);
  await loaded(page);
  await openPanel(page);
  await page.click('#clutch');
  await page.waitForFunction(() => window.__pcavr.state?.isEngaged);
  await page.evaluate(() => {
    const status = document.querySelector('#connection');
    const note = () => (window.__said ??= []).push(status.textContent);
    new MutationObserver(note).observe(status, { childList: true });
  });
  relay.drop();
  await page.waitForFunction(() => window.__pcavr.connection !== 'open');
  assert.equal(await page.evaluate(() => window.__pcavr.state), null);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  await until(() => page.evaluate(() => window.__pcavr.connection === 'open'), 'connected again');
  await page.waitForTimeout(200);
  assert.equal(await page.evaluate(() => window.__pcavr.state.isEngaged), false, 'takes hold anew');
  // Once, however often it tries: a screen reader reads each of them out.
  assert.deepEqual(await page.evaluate(() => window.__said), ['lost, trying again', 'connected']);
});

test('a page that says much at once, after a pause of its own, is still heard', limit, async () => {
  const page = new Live(stage.server.url);
  await until(() => page.state, 'the first state');
  for (let i = 0; i < 60; ++i) page.tool(page.state.hip, false);
  const { cycles } = page.state;
  await until(() => page.isClosed || page.state.cycles > cycles + 300, 'later states');
  assert.equal(page.isClosed, false);
  page.command(4);
  await until(() => page.state.hasTool, 'the tool taken');
  page.close();
});

test('what is no message ends that page alone', limit, async () => {
  const page = new Live(stage.server.url);
  const stranger = new Live(stage.server.url);
  await until(() => page.state && stranger.state, 'the first states');
  stranger.socket.send(Buffer.from('PCVR and nonsense that is longer than a head'));
  await stranger.ended;
  assert.ok(stranger.notices.some((n) => n.level === 'error'));
  const { cycles } = page.state;
  await until(() => page.state.cycles > cycles + 100, 'later states');
  page.close();
});
