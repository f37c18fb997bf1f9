// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { picture } from './support/browser.mjs';
import { flick, frames, moveBy, press, takeHold } from './support/controller.mjs';
import { enterVr, placeOf } from './support/headset.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const rounding = 1e-5; // [m] of numbers in single precision near 1

let world;
const stage = setStage({ headset: true, world: true }, () => ({ world } = stage));

test(
  'a snap turn is 30 degrees about the head, and a stick that stays turns once',
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

test('a teleport goes to the ring, and keeps height and heading', limit, async () => {
  const { page } = await enterVr(stage);
  const before = await placeOf(page);
  // Down and ahead: the ring is on the floor, or on what things stand on.
  await page.evaluate(() => {
    const { quaternion } = window.__headset.controllers.left;
    quaternion.set(Math.sin(-0.2), 0, 0, Math.cos(-0.2));
    window.__headset.controllers.left.updateAxes('thumbstick', 0, -1);
  });
  await frames(page, 4);
  const ring = await page.evaluate(() => window.__pcavr.vr.teleportTarget);
  assert.ok(ring);
  await picture(page, 'vr-teleport');
  await page.evaluate(() => window.__headset.controllers.left.updateAxes('thumbstick', 0, 0));
  await frames(page, 4);
  const after = await placeOf(page);
  assert.ok(distance(after.head, [ring[0], ring[1], before.head[2]]) < rounding);
  assert.ok(Math.abs(after.heading - before.heading) < rounding);
});

test('in a world shown larger the tool moves as much less', limit, async () => {
  const { page } = await enterVr(stage);
  for (const scale of [2, 4, 0.5, 1]) {
    await press(page, 'left', 'y-button', true);
    await press(page, 'left', 'y-button', false);
    // Again, where a machine that is busy elsewhere lets the tool go under way.
    await until(async () => {
      await takeHold(page, world);
      const before = world.state.hip;
      await moveBy(page, 'right', [0, 0.06, 0], 0.3);
      const isThere = () => Math.abs(world.state.hip[2] - before[2] - 0.06 / scale) < rounding;
      const wasThere = await until(isThere, '6 cm', 1000).catch(() => false);
      await moveBy(page, 'right', [0, -0.06, 0], 0.3);
      await press(page, 'right', 'squeeze', false);
      await until(() => !world.state.isEngaged, 'the clutch open');
      return wasThere;
    }, `6 cm at ${scale}`);
  }
});

test('the hands change, and then the left one has the tool', limit, async () => {
  const { page } = await enterVr(stage);
  await press(page, 'right', 'b-button', true);
  await press(page, 'right', 'b-button', false);
  // The button is now the free hand's, whose press scales the world: this one was the swap's.
  assert.equal(await page.evaluate(() => window.__pcavr.vr.person.scale), 1);
  await press(page, 'right', 'squeeze', true);
  await page.waitForTimeout(200);
  assert.equal(world.state.isEngaged, false);
  await press(page, 'left', 'trigger', true);
  await until(() => world.state.isEngaged, 'the left hand holds the tool');
});

test('a bare hand holds the tool by a pinch', limit, async () => {
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
  await until(() => world.state.isEngaged, 'the pinch holds the tool');
  const before = world.state.hip;
  await page.evaluate(() => window.__headset.hands.right.position.set(0.2, 1.25, -0.4));
  await until(() => Math.abs(world.state.hip[2] - before[2] - 0.05) < rounding, '5 cm up');
  await picture(page, 'vr-hands');
  await pinch(0);
  await until(() => !world.state.isEngaged, 'let go');
  assert.deepEqual(seen.errors, []);
});

test('a fingertip on the panel beside the other hand holds, and goes on', limit, async () => {
  const { page } = await enterVr(stage);
  await page.evaluate(() => window.__headset.controllers.left.position.set(-0.1, 1.2, -0.4));
  await frames(page, 3);
  // The button's middle, in front of the sheet and on it.
  const reach = (away) =>
    page.evaluate((z) => {
      const { mesh } = window.__pcavr.vr.panel;
      const {
        x,
        y,
        z: depth,
      } = mesh.position.clone().set(-0.034, -0.034, z).applyMatrix4(mesh.matrix);
      window.__headset.controllers.right.position.set(x, y, depth);
    }, away);
  const touch = async () => {
    await reach(0.1);
    await frames(page, 3);
    await reach(0.005);
    await frames(page, 3);
  };
  await touch();
  await until(() => world.state.isOnHold, 'hold');
  await frames(page, 10);
  assert.equal(world.state.isOnHold, true, 'a finger that stays presses once');
  await touch();
  await until(() => !world.state.isOnHold, 'go on');
});
