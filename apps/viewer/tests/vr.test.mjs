// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { picture } from './support/browser.mjs';
import { flick, frames, moveBy, press, takeHold, toHeadset } from './support/controller.mjs';
import { enterVr } from './support/headset.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';
import { drawnBodies } from './support/drawn.mjs';

const sameAsWorld = 1e-4; // [m] as the page is asked to be
const stillness = 2e-5; // [m] of numbers in single precision that stand still

let world;
const stage = setStage({ headset: true, world: true }, () => ({ world } = stage));

/// Leads the tool to a place in base. A machine that is busy elsewhere may let it go under way:
/// then the hand takes hold anew.
async function leadTo(page, place, speed) {
  await until(async () => {
    if (!world.state.isEngaged) await takeHold(page, world);
    const by = place.map((value, i) => value - world.state.hip[i]);
    await moveBy(page, 'right', toHeadset(by, heading()), speed);
    await frames(page, 10);
    return distance(world.state.hip, place) < 2e-3;
  }, `the tool at ${place}`);
}

/// Where a person looks at the start: from the base to the middle of what can be pushed.
function heading() {
  const middle = (axis) => start.reduce((sum, p) => sum + p[axis], 0);
  return Math.atan2(middle(1), middle(0));
}
let start;

async function resetWorld() {
  await until(() => !world.state.isToolTaken, 'the tool given back');
  world.command(2);
  world.command(3);
  await new Promise((resolve) => setTimeout(resolve, 300));
  start = world.state.objects.map((o) => o.position);
}

test(
  'a controller pushes a box, the picture shows what the world says, and the hand feels it',
  limit,
  async () => {
    await resetWorld();
    const { page, seen } = await enterVr(stage);
    const [x, y, z] = start[0];
    await takeHold(page, world);
    await leadTo(page, [world.state.hip[0], world.state.hip[1], 0.3], 0.4);
    await leadTo(page, [x - 0.25, y, 0.3], 0.4);
    await leadTo(page, [x - 0.25, y, z], 0.4);
    const before = world.state.pulses;
    await moveBy(page, 'right', toHeadset([0.25, 0, 0], heading()), 0.15);
    await picture(page, 'vr-pushing');
    await until(() => world.state.objects[0].position[0] > x + 0.05, 'the box pushed');
    assert.ok(world.state.pulses > before);
    await press(page, 'right', 'squeeze', false);
    await until(() => world.state.objects[0].speed < 1e-4, 'the box at rest');
    const drawn = await until(async () => {
      const bodies = await drawnBodies(page);
      return distance(bodies[0].position, world.state.objects[0].position) < sameAsWorld && bodies;
    }, 'the drawn box where the world has it');
    assert.ok(distance(drawn[1].position, world.state.objects[1].position) < sameAsWorld);
    const felt = await page.evaluate(() => window.__felt);
    assert.ok(
      felt.some((f) => f.value === 1 && f.milliseconds === 25),
      'a crisp pulse',
    );
    assert.ok(
      felt.some((f) => f.milliseconds === 40),
      'a rumble while it slides',
    );
    assert.ok(
      felt.every((f) => f.side === 'right'),
      'the other hand feels nothing',
    );
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

test('without the clutch, on hold, and by the head alone nothing moves', limit, async () => {
  await resetWorld();
  const { page } = await enterVr(stage);
  const before = world.state.hip;
  const stays = (what) => assert.ok(distance(world.state.hip, before) < stillness, what);

  await moveBy(page, 'right', [0.1, 0.1, 0], 0.5);
  stays('the clutch is open');
  assert.equal(world.state.isEngaged, false);

  await page.evaluate(() => window.__headset.position.set(0.5, 1.2, 0.3));
  await flick(page, 'left', 1, 0);
  await flick(page, 'left', 0, -1);
  await press(page, 'left', 'y-button', true);
  await press(page, 'left', 'y-button', false);
  stays('the person moved, not the tool');

  await takeHold(page, world);
  await page.evaluate(() => window.__headset.position.set(0, 1.6, 0));
  await flick(page, 'left', 1, 0);
  stays('the head moved while the clutch was closed');

  await press(page, 'right', 'a-button', true);
  await press(page, 'right', 'a-button', false);
  await until(() => world.state.isOnHold, 'hold');
  await moveBy(page, 'right', [0, 0.1, 0], 0.5);
  stays('on hold');
  await picture(page, 'vr-hold');
  await press(page, 'right', 'a-button', true);
  await press(page, 'right', 'a-button', false);
  await until(() => !world.state.isOnHold, 'go on');
  await moveBy(page, 'right', [0, 0.1, 0], 0.5);
  stays('after hold the hand has to take hold anew');

  await takeHold(page, world);
  await moveBy(page, 'right', [0, 0.05, 0], 0.5);
  await until(() => world.state.hip[2] > before[2] + 0.01, 'the tool follows again');
  await page.close();
});

test(
  'a lost controller, a hidden page, a page that is closed: each lets the tool go',
  limit,
  async () => {
    const ways = {
      'a controller that is gone': (page) =>
        page.evaluate(() => (window.__headset.controllers.right.connected = false)),
      'a controller whose place is a guess': (page) =>
        page.evaluate(() => (window.__isGuessed = true)),
      'a headset that is put off': (page) =>
        page.evaluate(() => window.__headset.updateVisibilityState('hidden')),
      'a window without the focus': (page) =>
        page.evaluate(() => window.dispatchEvent(new Event('blur'))),
      'VR that is left': (page) => page.evaluate(() => window.__headset.activeSession.end()),
      'a page that is closed': (page) => page.close(),
    };
    for (const [name, lose] of Object.entries(ways)) {
      await resetWorld();
      const { page } = await enterVr(stage);
      await takeHold(page, world);
      await lose(page);
      await until(() => !world.state.isEngaged, `${name}: let go`, 2000);
      const before = world.state.hip;
      if (!page.isClosed()) {
        await page.evaluate(() => window.__headset.controllers.right.position.set(0, 1, -1));
        await page.waitForTimeout(200);
      }
      assert.ok(distance(world.state.hip, before) < stillness, name);
      if (!page.isClosed()) await page.close();
    }
  },
);

test('both eyes see the scene, each from its own side', limit, async () => {
  await resetWorld();
  const { page, seen } = await enterVr(stage);
  await page.evaluate(() => {
    window.__headset.quaternion.set(Math.sin(-0.35), 0, 0, Math.cos(-0.35));
    window.__headset.controllers.left.position.set(-0.2, 1.25, -0.4);
    window.__headset.controllers.right.position.set(0.2, 1.2, -0.4);
  });
  await frames(page, 5);
  await picture(page, 'vr-both-eyes');
  assert.ok(await page.locator('#labels').isHidden(), 'labels are for the flat picture');
  const eyes = await page.evaluate(() =>
    window.__pcavr.app.renderer.xr
      .getCamera()
      .cameras.map((c) => c.matrixWorld.elements.slice(12, 15)),
  );
  assert.equal(eyes.length, 2);
  assert.ok(Math.abs(distance(...eyes) - 0.063) < 1e-3);
  assert.deepEqual(seen.errors, []);
});
