// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded, onScreen } from './support/drawn.mjs';
import { distance } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const tolerance = 1e-4; // [m]
const urdf = fileURLToPath(
  new URL('../../../calib/robots/irb120_like/irb120_like.urdf', import.meta.url),
);
// Where the tool's start is in reach.
const base = 'pose: {t: [0.15, 0.0, 0.0], q: [0, 0, 0, 1]}';
const joints = 6;

/// The joints at a time of the log [s].
const positions = (t) => {
  const [sin, cos] = [Math.sin(t), Math.cos(t)];
  return [0.2 * sin, 0.4, 0.3 + 0.1 * cos, 0.1 * sin, 0.7, 0.5 * sin];
};

/// The recording gets an arm and its log before the scene is built.
function addArm(recording) {
  cpSync(urdf, join(recording, 'arm.urdf'));
  const manifest = join(recording, 'recording.yaml');
  const text = readFileSync(manifest, 'utf8');
  writeFileSync(manifest, `${text}robot: {urdf: arm.urdf, ${base}}\n`);
  const tool = readFileSync(join(recording, 'tool.csv'), 'utf8').trim().split('\n').slice(1);
  const stamps = tool.map((line) => line.split(',')[0]);
  const names = Array.from({ length: joints }, (_, i) => `q_${i + 1}`);
  const rows = stamps.map((t, i) => [t, ...positions(0.01 * i).map((q) => q.toFixed(9))].join(','));
  writeFileSync(join(recording, 'joints.csv'), [`t,${names.join(',')}`, ...rows, ''].join('\n'));
}

let world;
const stage = setStage({ world: true, changeRecording: addArm }, () => ({ world } = stage));

const drawnArm = (page) => page.evaluate(() => window.__pcavr.arm);
const tipOf = (arm) => arm.links.at(-1).position;

/// Moves the server's tool until the arm's tip is at it, by the server's own kinematics.
async function moveTo(page, target) {
  for (let round = 0; round < 200; ++round) {
    world.tool(target, true);
    await page.waitForTimeout(50);
    const isThere = await page.evaluate((target) => {
      const { state } = window.__pcavr;
      const apart = Math.hypot(...target.map((value, i) => value - state.proxy[i]));
      return state.arm.isReached && apart < 2e-5;
    }, target);
    if (isThere) return;
  }
  throw new Error(`the arm does not reach ${target}`);
}

test('the arm is drawn with its tip where the server has brought it', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state?.arm);
  const start = world.state.proxy;
  world.command(4); // take the tool
  world.tool(start, false);
  for (const offset of [
    [0, 0, 0],
    [0.03, 0.05, 0.02],
    [-0.04, 0.02, 0.06],
    [0.02, -0.06, 0.01],
  ]) {
    const target = start.map((value, i) => value + offset[i]);
    await moveTo(page, target);
    await page.waitForTimeout(100); // until the state is drawn
    const arm = await drawnArm(page);
    assert.ok(distance(tipOf(arm), target) <= tolerance, `${tipOf(arm)} for ${target}`);
  }
  assert.match(await page.locator('#arm-line').textContent(), /^(arm: .* mm from .*)?$/);
  const foot = await onScreen(page, [0.15, 0.0, 0.0]);
  const label = await page.locator('#labels .robot').boundingBox();
  const away = Math.hypot(label.x + label.width / 2 - foot.x, label.y + label.height / 2 - foot.y);
  assert.ok(away < label.width, `the robot's label is ${away} px from where the arm stands`);
  await screenshot(page, 'arm_light');
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.waitForTimeout(300);
  await screenshot(page, 'arm_dark');
  assert.deepEqual(seen.errors, []);
});
