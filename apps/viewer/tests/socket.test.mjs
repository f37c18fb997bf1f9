// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { loaded, openPanel } from './support/drawn.mjs';
import { Live, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';
import { startRelay } from './support/relay.mjs';

const stage = setStage();

test('a page with another protocol version gets a notice and is disconnected', limit, async () => {
  const other = new Live(stage.server.url, { protocol: 2 });
  await other.ended;
  assert.equal(other.state, null);
  assert.ok(other.notices.some((n) => n.level === 'error' && /protocol/.test(n.text)));
});

test('a page reports a server with another protocol, and shows no state', limit, async (t) => {
  const relay = await startRelay(stage.server.url, (message) => {
    // The version byte of every message from the server, set to a later one.
    message[4] = 2;
    return message;
  });
  t.after(relay.close);
  const { page } = await stage.open(relay.url);
  await page.locator('#toasts', { hasText: /version 2/ }).waitFor();
  assert.equal(await page.evaluate(() => window.__pcavr.connection), 'refused');
  assert.equal(await page.evaluate(() => window.__pcavr.state), null);
});

// The header of docs/live-protocol.md.
const headerBytes = 24;
const lengthAt = 12;
const isState = (message) => message[5] === 2;

test('a page says that it cannot read the states, and that none comes', limit, async (t) => {
  const longer = await startRelay(stage.server.url, (message) => {
    if (!isState(message)) return message;
    const other = Buffer.concat([message, Buffer.alloc(4)]); // as of a server with more to say
    other.writeUInt32LE(other.length - headerBytes, lengthAt);
    return other;
  });
  t.after(longer.close);
  const { page } = await stage.open(longer.url);
  await page.locator('#toasts', { hasText: /another layout: reload/ }).waitFor();
  assert.equal(await page.evaluate(() => window.__pcavr.connection), 'refused');

  const silent = await startRelay(stage.server.url, (message) =>
    isState(message) ? null : message,
  );
  t.after(silent.close);
  const { page: waiting } = await stage.open(silent.url);
  await waiting.waitForFunction(() => window.__pcavr?.connection === 'lost');
});

test('a page reconnects after the connection is lost', limit, async (t) => {
  const relay = await startRelay(stage.server.url, (message) => message);
  t.after(relay.close);
  const { page } = await stage.open(relay.url);
  await loaded(page);
  await openPanel(page);
  await page.click('#clutch');
  await page.waitForFunction(() => window.__pcavr.state?.isEngaged);
  await page.evaluate(() => {
    const status = document.querySelector('#connection');
    const record = () => (window.__statuses ??= []).push(status.textContent);
    new MutationObserver(record).observe(status, { childList: true });
  });
  relay.drop();
  await page.waitForFunction(() => window.__pcavr.connection !== 'open');
  assert.equal(await page.evaluate(() => window.__pcavr.state), null);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  await until(() => page.evaluate(() => window.__pcavr.connection === 'open'), 'connected again');
  await page.waitForTimeout(200);
  assert.equal(await page.evaluate(() => window.__pcavr.state.isEngaged), false, 'clutch is open');
  // One change each, whatever the number of retries: a screen reader reads each one out.
  assert.deepEqual(await page.evaluate(() => window.__statuses), [
    'disconnected, reconnecting',
    'connected',
  ]);
});

test('a burst of messages from a page does not end its connection', limit, async () => {
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

test('a malformed message ends the connection of its sender only', limit, async () => {
  const page = new Live(stage.server.url);
  const other = new Live(stage.server.url);
  await until(() => page.state && other.state, 'the first states');
  other.socket.send(Buffer.from('PCVR and nonsense that is longer than a head'));
  await other.ended;
  assert.ok(other.notices.some((n) => n.level === 'error'));
  const { cycles } = page.state;
  await until(() => page.state.cycles > cycles + 100, 'later states');
  page.close();
});
