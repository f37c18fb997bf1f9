// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { Live, until } from './support/live.mjs';
import { serve, serveAt } from './support/pcavr.mjs';
import { limit, sceneArguments, setStage } from './support/stage.mjs';

const maxDelay = 500; // [ms] from the server's death to a page that says so

const stage = setStage();
const servers = [];
after(() => Promise.all(servers.map((server) => server.signal('SIGKILL') && server.ended)));

async function openOn(server) {
  servers.push(server);
  const { page, seen } = await stage.open(server.url);
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  await page.waitForTimeout(500); // a loaded page draws at its full rate
  await page.evaluate(() => {
    const lost = document.querySelector('#lost');
    new MutationObserver(() => {
      if (!lost.hidden) window.__lostAt ??= Date.now();
    }).observe(lost, { attributes: true });
  });
  return { page, seen };
}

/// Expects the page to say that the connection is lost, and returns how long that took [ms].
async function expectLost(page, since) {
  const lost = page.locator('#lost', { hasText: 'Connection lost' });
  await lost.waitFor();
  const delay = (await page.evaluate(() => window.__lostAt)) - since;
  // The phases follow with the next frame.
  await page.locator('#objects .phase', { hasText: '–' }).first().waitFor();
  assert.deepEqual(await page.locator('#objects .phase').allTextContents(), ['–', '–']);
  assert.deepEqual(await page.locator('#objects .number').allTextContents(), ['–', '–']);
  for (const text of await page.locator('#labels > .phase').allTextContents())
    assert.match(text, / · –$/);
  assert.equal(await page.locator('#hud-line').textContent(), 'no state');
  assert.equal(await page.locator('#call-to-action').isVisible(), false);
  return delay;
}

test('a page says within half a second that its server is gone', limit, async () => {
  const server = await serve(...sceneArguments(stage.scene));
  const { page } = await openOn(server);
  const since = Date.now();
  server.signal('SIGKILL');
  const delay = await expectLost(page, since);
  assert.ok(delay < maxDelay, `${delay} ms`);
  await screenshot(page, 'lost');
});

test(
  'a page says within half a second that its server hangs, and goes on with it',
  limit,
  async () => {
    const server = await serve(...sceneArguments(stage.scene));
    const { page, seen } = await openOn(server);
    const since = Date.now();
    server.signal('SIGSTOP');
    const delay = await expectLost(page, since);
    assert.ok(delay < maxDelay, `${delay} ms`);
    server.signal('SIGCONT');
    await page.locator('#lost').waitFor({ state: 'hidden' });
    await page.locator('#objects .phase', { hasText: 'free' }).first().waitFor();
    assert.equal(await page.locator('#connection').textContent(), 'connected');
    assert.deepEqual(seen.errors, []);
  },
);

test(
  'a server restarted with another scene loads the page again, and that is said',
  limit,
  async () => {
    const first = await serve(...sceneArguments(stage.scene));
    const { page } = await openOn(first);
    const other = join(stage.scene.folder, 'other');
    cpSync(stage.scene.scene, other, { recursive: true });
    first.signal('SIGKILL');
    await first.ended;
    const { port } = new URL(first.url);
    servers.push(await serveAt(port, other, '--parameters', stage.scene.parameters));
    await page.locator('#toasts', { hasText: 'restarted with the scene "other"' }).waitFor();
    await page.locator('#scene-name', { hasText: 'other' }).waitFor();
    await loaded(page);
    await page.waitForFunction(() => window.__pcavr.state !== null);
  },
);

test('a server restarted with the same scene is announced', limit, async () => {
  const first = await serve(...sceneArguments(stage.scene));
  const { page } = await openOn(first);
  first.signal('SIGKILL');
  await first.ended;
  servers.push(await serveAt(new URL(first.url).port, ...sceneArguments(stage.scene)));
  await page.locator('#toasts', { hasText: 'The server was restarted' }).waitFor();
  await page.locator('#lost').waitFor({ state: 'hidden' });
});

test(
  'a page without its graphics context opens the clutch, says so and draws again',
  limit,
  async () => {
    const { page } = await stage.open();
    await loaded(page);
    await page.waitForFunction(() => window.__pcavr.state !== null);
    const drag = async () => {
      const ring = await page.locator('#handle').boundingBox();
      await page.mouse.move(ring.x + ring.width / 2, ring.y + ring.height / 2);
      await page.mouse.down();
      await page.mouse.move(ring.x + ring.width / 2 + 8, ring.y + ring.height / 2, { steps: 4 });
    };
    await drag();
    await page.waitForFunction(() => window.__pcavr.state.isEngaged);
    await page.evaluate(() => {
      const { app } = window.__pcavr;
      window.__loss = app.renderer.getContext().getExtension('WEBGL_lose_context');
      window.__loss.loseContext();
    });
    await page.locator('#no-picture', { hasText: 'No picture' }).waitFor();
    // Counted from here: the browser says later than at once that the context is lost.
    await page.evaluate(() => {
      window.__pcavr.app.onDrawn(() => (window.__drawn = (window.__drawn ?? 0) + 1));
    });
    await page.waitForFunction(() => !window.__pcavr.state.isEngaged);
    await page.mouse.up();
    await drag();
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.__pcavr.state.isEngaged), false, 'a blind drag');
    assert.equal(await page.evaluate(() => window.__drawn ?? 0), 0);
    await page.mouse.up();
    await page.evaluate(() => window.__loss.restoreContext());
    await page.locator('#no-picture').waitFor({ state: 'hidden' });
    await page.waitForFunction(() => window.__drawn > 0);
    await screenshot(page, 'picture-restored');
    await drag();
    await page.waitForFunction(() => window.__pcavr.state.isEngaged);
    await page.mouse.up();
  },
);

test('a drag that a gap has ended says so, and pressing again resumes', limit, async () => {
  const server = await serve(...sceneArguments(stage.scene));
  const { page } = await openOn(server);
  const press = async () => {
    const ring = await page.locator('#handle').boundingBox();
    await page.mouse.move(ring.x + ring.width / 2, ring.y + ring.height / 2);
    await page.mouse.down();
  };
  await press();
  await page.waitForFunction(() => window.__pcavr.state.isEngaged);
  server.signal('SIGSTOP');
  await page.locator('#toasts', { hasText: 'The drag has ended' }).waitFor();
  server.signal('SIGCONT');
  await page.waitForFunction(() => window.__pcavr.state?.isEngaged === false);
  await page.mouse.up();
  await page.locator('#lost').waitFor({ state: 'hidden' });
  await press();
  await page.waitForFunction(() => window.__pcavr.state?.isEngaged);
  await page.mouse.up();
});

test('a server that was down for long is back within two seconds', limit, async () => {
  const first = await serve(...sceneArguments(stage.scene));
  const { page } = await openOn(first);
  first.signal('SIGKILL');
  await first.ended;
  await page.waitForTimeout(5000); // the pause between two attempts has grown
  servers.push(await serveAt(new URL(first.url).port, ...sceneArguments(stage.scene)));
  const since = Date.now();
  await page.waitForFunction(() => window.__pcavr.state !== null, null, { polling: 50 });
  assert.ok(Date.now() - since < 2000, `${Date.now() - since} ms`);
});

test('a page asks for the tool, and the one that has it hands it over', limit, async () => {
  const { page } = await stage.open();
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  await page.click('#take');
  await page.waitForFunction(() => window.__pcavr.state?.hasTool);
  const world = new Live(stage.server.url);
  await until(() => world.state, 'the first state');
  world.command(4);
  await page.locator('#tool-request').waitFor();
  await screenshot(page, 'tool_request');
  await page.click('#keep');
  await until(() => world.notices.some(({ text }) => /keeps it/.test(text)), 'a notice');
  world.close();
  const other = new Live(stage.server.url);
  await until(() => other.state, 'the first state');
  other.command(4);
  await page.click('#hand-over');
  await until(() => other.state.hasTool, 'the tool handed over');
  await page.click('#take', { trial: true });
  assert.equal(await page.locator('#take').textContent(), 'Ask for the tool');
  await page.click('#take');
  await page.locator('#take', { hasText: 'Stop asking' }).waitFor();
  other.command(11);
  await page.locator('#tool-owner', { hasText: 'You are using the tool.' }).waitFor();
  other.close();
});

test('an idle tool goes to the page that uses it', limit, async () => {
  const { page } = await stage.open();
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  const world = new Live(stage.server.url);
  await until(() => world.state, 'the first state');
  world.command(4);
  await until(() => world.state.hasTool, 'the tool taken');
  await page.locator('#tool-owner', { hasText: 'Another page uses the tool.' }).waitFor();
  await page.locator('#tool-owner', { hasText: 'The tool is free' }).waitFor({ timeout: 15_000 });
  assert.equal(world.state.hasTool, true, 'until another page requests it');
  await page.click('#take');
  await until(() => !world.state.hasTool && world.state.isToolTaken, 'the tool of the page');
  await until(() => world.notices.some(({ text }) => /not used for 10 s/.test(text)), 'a notice');
  world.close();
});
