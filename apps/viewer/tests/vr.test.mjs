// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { flick, frames, moveBy, press, closeClutch, toHeadset } from './support/controller.mjs';
import { enterVr } from './support/headset.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';
import { drawnBodies } from './support/drawn.mjs';

const poseTolerance = 1e-4; // [m] required of the page
const restTolerance = 2e-5; // [m] single precision at rest

let world;
const stage = setStage({ headset: true, world: true }, () => ({ world } = stage));

/// Moves the tool to a point in base. On a busy machine the clutch may open on the way: then it is
/// closed again.
async function moveToolTo(page, target, speed) {
  await until(async () => {
    if (!world.state.isEngaged) await closeClutch(page, world);
    const delta = target.map((value, i) => value - world.state.hip[i]);
    await moveBy(page, 'right', toHeadset(delta, heading()), speed);
    await frames(page, 10);
    return distance(world.state.hip, target) < 2e-3;
  }, `the tool at ${target}`);
}

/// The user's initial heading: from the base to the mean of the movable bodies.
function heading() {
  const sum = (axis) => start.reduce((total, p) => total + p[axis], 0);
  return Math.atan2(sum(1), sum(0));
}
let start;

async function resetWorld() {
  await until(() => !world.state.isToolTaken, 'the tool released');
  world.command(2);
  world.command(3);
  await new Promise((resolve) => setTimeout(resolve, 300));
  start = world.state.objects.map((o) => o.position);
}

test(
  'a controller pushes a box, the page shows the state of the world, and the controller vibrates',
  limit,
  async () => {
    await resetWorld();
    const { page, seen } = await enterVr(stage);
    const [x, y, z] = start[0];
    await closeClutch(page, world);
    await moveToolTo(page, [world.state.hip[0], world.state.hip[1], 0.3], 0.4);
    await moveToolTo(page, [x - 0.25, y, 0.3], 0.4);
    await moveToolTo(page, [x - 0.25, y, z], 0.4);
    const before = world.state.pulses;
    await moveBy(page, 'right', toHeadset([0.25, 0, 0], heading()), 0.15);
    await screenshot(page, 'vr-pushing');
    await until(() => world.state.objects[0].position[0] > x + 0.05, 'the box pushed');
    assert.ok(world.state.pulses > before);
    await press(page, 'right', 'squeeze', false);
    await until(() => world.state.objects[0].speed < 1e-4, 'the box at rest');
    const drawn = await until(async () => {
      const bodies = await drawnBodies(page);
      return (
        distance(bodies[0].position, world.state.objects[0].position) < poseTolerance && bodies
      );
    }, 'the drawn box at its pose in the world');
    assert.ok(distance(drawn[1].position, world.state.objects[1].position) < poseTolerance);
    const pulses = await page.evaluate(() => window.__hapticPulses);
    assert.ok(
      pulses.some((p) => p.value === 1 && p.milliseconds === 25),
      'an event pulse',
    );
    assert.ok(
      pulses.some((p) => p.milliseconds === 40),
      'a rumble during sliding',
    );
    assert.ok(
      pulses.every((p) => p.side === 'right'),
      'no pulse on the other hand',
    );
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

test('the tool stays with an open clutch, on hold, and under head motion', limit, async () => {
  await resetWorld();
  const { page } = await enterVr(stage);
  const before = world.state.hip;
  const stays = (what) => assert.ok(distance(world.state.hip, before) < restTolerance, what);

  await moveBy(page, 'right', [0.1, 0.1, 0], 0.5);
  stays('the clutch is open');
  assert.equal(world.state.isEngaged, false);

  await page.evaluate(() => window.__headset.position.set(0.5, 1.2, 0.3));
  await flick(page, 'left', 1, 0);
  await flick(page, 'left', 0, -1);
  await press(page, 'left', 'y-button', true);
  await press(page, 'left', 'y-button', false);
  stays('the user moved, not the tool');

  await closeClutch(page, world);
  await page.evaluate(() => window.__headset.position.set(0, 1.6, 0));
  await flick(page, 'left', 1, 0);
  stays('the head moved while the clutch was closed');

  await press(page, 'right', 'a-button', true);
  await press(page, 'right', 'a-button', false);
  await until(() => world.state.isOnHold, 'hold');
  await moveBy(page, 'right', [0, 0.1, 0], 0.5);
  stays('on hold');
  await screenshot(page, 'vr-hold');
  await press(page, 'right', 'a-button', true);
  await press(page, 'right', 'a-button', false);
  await until(() => !world.state.isOnHold, 'resumed');
  await moveBy(page, 'right', [0, 0.1, 0], 0.5);
  stays('after hold the clutch has to be closed again');

  await closeClutch(page, world);
  await moveBy(page, 'right', [0, 0.05, 0], 0.5);
  await until(() => world.state.hip[2] > before[2] + 0.01, 'the tool follows again');
  await page.close();
});

test(
  'a lost controller, a hidden page, a closed page: each one opens the clutch',
  limit,
  async () => {
    const interlocks = {
      'controller disconnected': (page) =>
        page.evaluate(() => (window.__headset.controllers.right.connected = false)),
      'controller position emulated': (page) => page.evaluate(() => (window.__isEmulated = true)),
      'headset taken off': (page) =>
        page.evaluate(() => window.__headset.updateVisibilityState('hidden')),
      'window lost focus': (page) => page.evaluate(() => window.dispatchEvent(new Event('blur'))),
      'VR session ended': (page) => page.evaluate(() => window.__headset.activeSession.end()),
      'page closed': (page) => page.close(),
    };
    for (const [name, trigger] of Object.entries(interlocks)) {
      await resetWorld();
      const { page } = await enterVr(stage);
      await closeClutch(page, world);
      await trigger(page);
      await until(() => !world.state.isEngaged, `${name}: clutch open`, 2000);
      const before = world.state.hip;
      if (!page.isClosed()) {
        await page.evaluate(() => window.__headset.controllers.right.position.set(0, 1, -1));
        await page.waitForTimeout(200);
      }
      assert.ok(distance(world.state.hip, before) < restTolerance, name);
      if (!page.isClosed()) await page.close();
    }
  },
);

test('both eyes render the scene, each from its own position', limit, async () => {
  await resetWorld();
  const { page, seen } = await enterVr(stage);
  await page.evaluate(() => {
    window.__headset.quaternion.set(Math.sin(-0.35), 0, 0, Math.cos(-0.35));
    window.__headset.controllers.left.position.set(-0.2, 1.25, -0.4);
    window.__headset.controllers.right.position.set(0.2, 1.2, -0.4);
  });
  await frames(page, 5);
  await screenshot(page, 'vr-both-eyes');
  assert.ok(await page.locator('#labels').isHidden(), 'labels are for the flat view');
  const eyes = await page.evaluate(() =>
    window.__pcavr.app.renderer.xr
      .getCamera()
      .cameras.map((c) => c.matrixWorld.elements.slice(12, 15)),
  );
  assert.equal(eyes.length, 2);
  assert.ok(Math.abs(distance(...eyes) - 0.063) < 1e-3);
  assert.deepEqual(seen.errors, []);
});
