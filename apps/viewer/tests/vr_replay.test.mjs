// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { frames } from './support/controller.mjs';
import { limit, sceneArguments, setStage } from './support/stage.mjs';

const serverArguments = ({ recording, ...scene }) => [
  ...sceneArguments(scene),
  ...['--replay', recording, '--tracked', join(recording, 'tracked')],
];
const stage = setStage({ serverArguments, headset: true });

/// Enters, looks down by 20 degrees, and puts the hands in front of the head.
async function enter(button) {
  const { page, seen } = await stage.open();
  await page.waitForFunction(() => window.__pcavr?.replay && window.__pcavr.scene.isComplete);
  await page.click(`${button}:enabled`);
  await page.waitForFunction(() => window.__pcavr.vr?.isPresenting);
  await page.evaluate(() => {
    const half = (-10 * Math.PI) / 180;
    window.__headset.quaternion.set(Math.sin(half), 0, 0, Math.cos(half));
    window.__headset.controllers.left.position.set(-0.2, 1.25, -0.4);
    window.__headset.controllers.right.position.set(0.2, 1.25, -0.4);
  });
  await frames(page, 4);
  return { page, seen };
}

/// Puts the right hand's tip at a place of the panel: a button's name, or a time on the bar.
async function touch(page, place, withdraws = true) {
  const reach = (depth) =>
    page.evaluate(
      ([where, z]) => {
        const { app, vr } = window.__pcavr;
        const { panel } = vr;
        const at =
          typeof where === 'string'
            ? panel.centerOf(where)
            : panel.placeOf(where, app.playback.duration);
        const { x, y, z: depth } = at.setZ(z).applyMatrix4(panel.mesh.matrix);
        window.__headset.controllers.right.position.set(x, y, depth);
      },
      [place, depth],
    );
  await reach(0.1);
  await frames(page, 3);
  await reach(0.004);
  await frames(page, 3);
  if (!withdraws) return;
  await reach(0.1);
  await frames(page, 3);
}

const playback = (page) =>
  page.evaluate(() => {
    const { time, duration, isPlaying, speed } = window.__pcavr.app.playback;
    return { time, duration, isPlaying, speed };
  });

test('in the headset a replay is played, paused, scrubbed and stepped', limit, async () => {
  const { page, seen } = await enter('#vr-button');
  const { duration } = await playback(page);
  await touch(page, 0.5 * duration);
  assert.ok(Math.abs((await playback(page)).time - 0.5 * duration) < 0.01 * duration);
  await screenshot(page, 'vr-replay');
  const paused = (await playback(page)).time;
  await touch(page, 'reset');
  assert.ok(Math.abs((await playback(page)).time - Math.max(0, paused - 1)) < 1e-6);
  await touch(page, 'take');
  assert.ok(Math.abs((await playback(page)).time - Math.min(duration, paused)) < 1e-6);
  await touch(page, 'swap');
  assert.equal((await playback(page)).speed, 2);
  await touch(page, 0);
  await touch(page, 'hold');
  await page.waitForFunction(() => window.__pcavr.app.playback.time > 0);
  await page.evaluate(() => window.__headset.controllers.left.updateButtonValue('x-button', 1));
  await page.waitForFunction(() => !window.__pcavr.app.playback.isPlaying);
  assert.deepEqual(seen.errors, []);
});

test('in the real room the scene is placed by a grip', limit, async () => {
  const { page, seen } = await enter('#passthrough-button');
  await touch(page, 'place');
  const at = (point) =>
    page.evaluate((p) => {
      const { vr, app } = window.__pcavr;
      const v = app.view.tool.proxy.position.clone().set(...p);
      return vr.person.toHeadset(v).toArray();
    }, point);
  const move = (x, y, z) =>
    page.evaluate((p) => window.__headset.controllers.right.position.set(...p), [x, y, z]);
  const squeeze = (value) =>
    page.evaluate((v) => window.__headset.controllers.right.updateButtonValue('squeeze', v), value);
  await move(0.2, 1.2, -0.4);
  await frames(page, 3);
  await squeeze(1);
  await frames(page, 3);
  const before = await at([0.5, 0, 0]);
  await move(0.3, 1.25, -0.6);
  await frames(page, 3);
  await squeeze(0);
  await frames(page, 3);
  const moved = (await at([0.5, 0, 0])).map((value, i) => value - before[i]);
  [0.1, 0.05, -0.2].forEach((value, i) => assert.ok(Math.abs(moved[i] - value) < 1e-5, `${moved}`));
  await screenshot(page, 'vr-room');
  await touch(page, 'place');
  assert.equal(await page.evaluate(() => window.__pcavr.vr.placing.isActive), false);
  assert.deepEqual(seen.errors, []);
});
