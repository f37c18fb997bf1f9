// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { flick, frames, moveBy, press, closeClutch } from './support/controller.mjs';
import { enterVr, placeOf } from './support/headset.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const rounding = 1e-5; // [m] single precision near 1

let world;
const stage = setStage({ headset: true, world: true }, () => ({ world } = stage));

test(
  'a snap turn is 30 degrees about the head, once per deflection of the stick',
  limit,
  async () => {
    const { page } = await enterVr(stage);
    const before = await placeOf(page);
    await flick(page, 'left', -1, 0);
    const after = await placeOf(page);
    assert.ok(distance(before.head, after.head) < rounding);
    assert.ok(Math.abs(after.heading - before.heading - Math.PI / 6) < rounding);
    await flick(page, 'left', 1, 0);
    assert.ok(Math.abs((await placeOf(page)).heading - before.heading) < rounding);
  },
);

test('a teleport moves to the ring, and keeps height and heading', limit, async () => {
  const { page } = await enterVr(stage);
  const before = await placeOf(page);
  // Down and forward: the ring is on the floor or on a support.
  await page.evaluate(() => {
    const { quaternion } = window.__headset.controllers.left;
    quaternion.set(Math.sin(-0.2), 0, 0, Math.cos(-0.2));
    window.__headset.controllers.left.updateAxes('thumbstick', 0, -1);
  });
  await frames(page, 4);
  const ring = await page.evaluate(() => window.__pcavr.vr.teleportTarget);
  assert.ok(ring);
  await screenshot(page, 'vr-teleport');
  await page.evaluate(() => window.__headset.controllers.left.updateAxes('thumbstick', 0, 0));
  await frames(page, 4);
  const after = await placeOf(page);
  assert.ok(distance(after.head, [ring[0], ring[1], before.head[2]]) < rounding);
  assert.ok(Math.abs(after.heading - before.heading) < rounding);
});

test('in a scaled world the tool motion is divided by the scale', limit, async () => {
  const { page } = await enterVr(stage);
  for (const scale of [2, 4, 0.5, 1]) {
    await press(page, 'left', 'y-button', true);
    await press(page, 'left', 'y-button', false);
    // Repeated if the clutch opens on the way on a busy machine.
    await until(async () => {
      await closeClutch(page, world);
      const before = world.state.hip;
      await moveBy(page, 'right', [0, 0.06, 0], 0.3);
      const hasArrived = () => Math.abs(world.state.hip[2] - before[2] - 0.06 / scale) < rounding;
      const arrived = await until(hasArrived, '6 cm', 1000).catch(() => false);
      await moveBy(page, 'right', [0, -0.06, 0], 0.3);
      await press(page, 'right', 'squeeze', false);
      await until(() => !world.state.isEngaged, 'the clutch open');
      return arrived;
    }, `6 cm at ${scale}`);
  }
});

test('after a swap the left hand has the tool', limit, async () => {
  const { page } = await enterVr(stage);
  await press(page, 'right', 'b-button', true);
  await press(page, 'right', 'b-button', false);
  // The button now belongs to the free hand, where it scales the world; this press only swapped.
  assert.equal(await page.evaluate(() => window.__pcavr.vr.person.scale), 1);
  await press(page, 'right', 'squeeze', true);
  await page.waitForTimeout(200);
  assert.equal(world.state.isEngaged, false);
  await press(page, 'left', 'trigger', true);
  await until(() => world.state.isEngaged, 'the left hand closes the clutch');
});

test('a tracked hand closes the clutch by a pinch', limit, async () => {
  const { page, seen } = await enterVr(stage);
  await page.evaluate(() => {
    window.__headset.primaryInputMode = 'hand';
    window.__headset.hands.left.position.set(-0.2, 1.2, -0.4);
    window.__headset.hands.right.position.set(0.2, 1.2, -0.4);
  });
  await frames(page, 4);
  assert.equal(world.state.isEngaged, false);
  const pinch = (value) =>
    page.evaluate((v) => window.__headset.hands.right.updatePinchValue(v), value);
  await pinch(1);
  await until(() => world.state.isEngaged, 'the pinch closes the clutch');
  const before = world.state.hip;
  await page.evaluate(() => window.__headset.hands.right.position.set(0.2, 1.25, -0.4));
  await until(() => Math.abs(world.state.hip[2] - before[2] - 0.05) < rounding, '5 cm up');
  await screenshot(page, 'vr-hands');
  await pinch(0);
  await until(() => !world.state.isEngaged, 'the clutch open');
  assert.deepEqual(seen.errors, []);
});

test('a fingertip on the panel at the other hand holds and resumes', limit, async () => {
  const { page } = await enterVr(stage);
  await page.evaluate(() => window.__headset.controllers.left.position.set(-0.1, 1.2, -0.4));
  await frames(page, 3);
  // The centre of the hold button, at a distance from the panel.
  const reach = (offset) =>
    page.evaluate((z) => {
      const { mesh } = window.__pcavr.vr.panel;
      const center = window.__pcavr.vr.panel.centerOf('hold');
      const { x, y, z: depth } = center.setZ(z).applyMatrix4(mesh.matrix);
      window.__headset.controllers.right.position.set(x, y, depth);
    }, offset);
  const touch = async () => {
    await reach(0.1);
    await frames(page, 3);
    await reach(0.005);
    await frames(page, 3);
  };
  await touch();
  await until(() => world.state.isOnHold, 'hold');
  await frames(page, 10);
  assert.equal(world.state.isOnHold, true, 'a finger that stays on the button presses once');
  await touch();
  await until(() => !world.state.isOnHold, 'resumed');
});
