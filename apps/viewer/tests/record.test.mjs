// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A live session that is recorded, and what reads the recording.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded, openPanel } from './support/drawn.mjs';
import { Live, until } from './support/live.mjs';
import { makeScene, serve } from './support/pcavr.mjs';

const limit = { timeout: 180_000 };
const made = makeScene();
const servers = [];
after(async () => {
  for (const server of servers) await server.stop();
  made.remove();
});
const path = (name) => join(made.folder, name);
const run = (...args) =>
  JSON.parse(
    execFileSync(process.env.PCAVR_COMMAND, ['--json', ...args], {
      stdio: ['ignore', 'pipe', 'pipe'],
    }),
  );

/// Pushes the first box by its side towards +y, and returns how far it moved [m].
async function pushABox(url) {
  const live = new Live(url);
  await until(() => live.state, 'a state');
  const [x, y, z] = live.state.objects[0].position;
  const beside = [x, y - 0.2, z];
  await live.moveToolOver(beside);
  await live.moveTool(beside, [x, y, z], 4);
  await live.moveTool([x, y, z], beside, 1);
  const moved = live.state.objects[0].position[1] - y;
  live.close();
  return moved;
}

test('a recorded live session is read by replay, evaluate and the page', limit, async () => {
  const server = await serve(
    ...[made.scene, '--parameters', made.parameters, '--record', path('session')],
  );
  servers.push(server);
  const moved = await pushABox(server.url);
  assert.ok(moved > 0.02, `the box moved by ${moved} m`);
  assert.equal(await server.stop(), 0);

  const replayed = run('replay', path('session'), '--scene', made.scene, '-o', path('run'));
  assert.ok(replayed, 'a result');
  run('evaluate', path('run'), '-o', path('report'));
  const report = JSON.parse(readFileSync(path('report/report.json'), 'utf8'));
  assert.ok(JSON.stringify(report).includes('predicted'), 'predicted poses are judged');

  const shown = await serve(made.scene, '--replay', path('session'));
  const browser = await openBrowser();
  try {
    const { page, seen } = await openPage(browser.context, shown.url);
    await loaded(page);
    await page.waitForFunction(() => window.__pcavr.replay);
    const [duration, poses] = await page.evaluate(() => {
      const { replay } = window.__pcavr;
      replay.seek(replay.timeline.duration);
      return [replay.timeline.duration, window.__pcavr.bodies];
    });
    assert.ok(duration > 6, `${duration} s`);
    assert.ok(poses.length > 0);
    await page.waitForTimeout(300);
    await screenshot(page, 'recorded-session');
    assert.deepEqual(seen.errors, []);
  } finally {
    await browser.close();
    await shown.stop();
  }
});

test(
  'a session is recorded by the button on the page, which says where it went',
  limit,
  async () => {
    const folder = path('by-page');
    const server = await serve(
      ...[made.scene, '--parameters', made.parameters, '--recordings', folder],
    );
    servers.push(server);
    const browser = await openBrowser();
    try {
      const { page, seen } = await openPage(browser.context, server.url);
      await loaded(page);
      await page.setViewportSize({ width: 1280, height: 800 });
      await openPanel(page);
      const place = page.locator('#recording-place');
      for (const name of ['recording_001', 'recording_002']) {
        await page.getByRole('button', { name: 'Record session' }).click();
        const stop = page.getByRole('button', { name: 'Stop recording' });
        await stop.waitFor();
        assert.equal(await stop.getAttribute('aria-pressed'), 'true');
        assert.equal(await place.textContent(), `recording to ${folder}/${name}`);
        if (name === 'recording_001') {
          await pushABox(server.url);
          await screenshot(page, 'recording-by-page');
        }
        await stop.click();
        await page.getByRole('button', { name: 'Record session' }).waitFor();
        await page.waitForFunction(() =>
          document.querySelector('#recording-place').textContent.startsWith('recorded '),
        );
        assert.match(
          await place.textContent(),
          new RegExp(`^recorded [\\d.]+ s to ${folder}/${name}$`),
        );
      }
      assert.deepEqual(seen.errors, []);
    } finally {
      await browser.close();
    }
    const replayed = run(
      'replay',
      `${folder}/recording_001`,
      '--scene',
      made.scene,
      '-o',
      path('run2'),
    );
    assert.ok(replayed, 'a result');
    const rows = readFileSync(join(folder, 'recording_001', 'tool.csv'), 'utf8')
      .trim()
      .split('\n');
    const [first, last] = [rows[1], rows.at(-1)].map((row) => Number(row.split(',')[0]));
    assert.ok(last - first > 4, `${last - first} s of the push`);
  },
);
