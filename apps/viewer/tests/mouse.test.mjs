// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { drawnBodies, loaded, onScreen, openPanel } from './support/drawn.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const poseTolerance = 1e-4; // [m]

let world;
const stage = setStage({ world: true }, () => ({ world } = stage));

/// Moves the pointer in small steps to where a point of base is drawn.
async function dragTo(page, point) {
  const { x, y } = await onScreen(page, point);
  await page.mouse.move(x, y, { steps: 25 });
}

async function grab(page) {
  const box = await page.locator('#handle').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
}

/// To the side of the box at the tool's height, down with Shift, then against the box. The pointer
/// stays down.
async function pushBox(page) {
  await page.locator('#handle').waitFor();
  const [x, y, z] = world.state.objects[0].position;
  const tool = world.state.proxy;
  await grab(page);
  await dragTo(page, [x - 0.22, y, tool[2]]);
  await page.keyboard.down('Shift');
  await dragTo(page, [x - 0.22, y, z]);
  await page.keyboard.up('Shift');
  await until(() => Math.abs(world.state.proxy[2] - z) < 0.03, 'the tool at the box height');
  await dragTo(page, [x + 0.02, y, z]);
  await screenshot(page, 'mouse-pushing');
  await until(() => world.state.objects[0].position[0] > x + 0.03, 'the box pushed');
}

test(
  'a dragged handle pushes a box, and the page shows the state of the world',
  limit,
  async () => {
    const { page, seen } = await stage.open();
    await loaded(page);
    await pushBox(page);
    // The plot has the box's phases, and the force at which it breaks away.
    await page
      .locator('.plot svg text', { hasText: 'box_1 breaks away' })
      .waitFor({ state: 'attached' });
    const bands = () =>
      page
        .locator('.plot svg g rect')
        .evaluateAll((all) => all.map((one) => one.getAttribute('fill')));
    const sliding = await page.evaluate(() => {
      const entries = [...document.querySelectorAll('#phase-legend .phase')];
      const entry = entries.find(({ textContent }) => textContent === 'sliding');
      return entry.style.getPropertyValue('--phase');
    });
    await until(async () => (await bands()).includes(sliding), 'a band of sliding');
    await page.mouse.up();
    await until(() => !world.state.isEngaged, 'the clutch open');
    await until(() => world.state.objects[0].speed < 1e-4, 'the box at rest');
    await until(async () => {
      const bodies = await drawnBodies(page);
      return distance(bodies[0].position, world.state.objects[0].position) < poseTolerance;
    }, 'the drawn box at its pose in the world');
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

// Frames of a busy machine are far apart: the pointer moves and Shift is pressed between two of them.
test('a drag counts up to where Shift begins another', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await grab(page);
  await until(() => world.state.isEngaged, 'the clutch closed');
  const [x, y, z] = world.state.proxy;
  const target = [x - 0.1, y, z];
  const pointer = await onScreen(page, target);
  await page.evaluate(({ x: clientX, y: clientY }) => {
    const handle = document.getElementById('handle');
    for (const shiftKey of [false, true])
      handle.dispatchEvent(new PointerEvent('pointermove', { clientX, clientY, shiftKey }));
  }, pointer);
  await until(() => distance(world.state.hip, target) < 0.02, 'the tool at the pointer');
  await page.mouse.up();
  await until(() => !world.state.isEngaged, 'the clutch open');
  assert.deepEqual(seen.errors, []);
  await page.close();
});

test('starting over can be undone until a body is touched', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await openPanel(page);
  const undo = page.locator('#undo-reset');
  const position = () => world.state.objects[0].position;
  const isAt = (point) => distance(position(), point) < poseTolerance;
  await page.click('#reset');
  await undo.waitFor();
  const start = position();
  await pushBox(page);
  await undo.waitFor({ state: 'hidden' });
  await page.mouse.up();
  await until(() => !world.state.isEngaged, 'the clutch open');
  await until(() => world.state.objects[0].speed < 1e-4, 'the box at rest');
  const pushed = position();
  await page.click('#reset');
  await until(() => isAt(start), 'the box at its start');
  await undo.waitFor();
  await screenshot(page, 'undo-offered');
  await undo.click();
  await page.getByText('reset undone').first().waitFor();
  await until(() => isAt(pushed), 'the box where it was pushed to');
  await undo.waitFor({ state: 'hidden' });
  await until(async () => {
    const bodies = await drawnBodies(page);
    return distance(bodies[0].position, position()) < poseTolerance;
  }, 'the drawn box at its pose in the world');
  await screenshot(page, 'undo-done');
  assert.deepEqual(seen.errors, []);
  await page.close();
});

test('buttons slow the time down, and the hand feels forces as much smaller', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await openPanel(page);
  const isAt = async (scale) => {
    await page.waitForFunction((wanted) => window.__pcavr.state?.timeScale === wanted, scale);
    await page.locator('#time-scale', { hasText: `${100 * scale} %` }).waitFor();
    const inHud = page.getByText(`time × ${scale}`);
    await inHud.waitFor({ state: scale < 1 ? 'visible' : 'detached' });
  };
  for (const scale of [0.5, 0.25, 0.1]) {
    await page.click('#slower');
    await isAt(scale);
  }
  const before = world.state.time;
  await page.waitForTimeout(1000);
  const passed = world.state.time - before;
  assert.ok(passed > 0.05 && passed < 0.3, `${passed} s of the world in a second`);
  await page.click('#slower'); // no slower than that
  for (const scale of [0.25, 0.5]) {
    await page.click('#faster');
    await isAt(scale);
  }
  const feelsHalf = () => {
    const onBox = Math.hypot(...world.state.objects[0].force);
    const felt = Math.hypot(...world.state.force);
    return onBox > 0.5 && Math.abs(felt / onBox - 0.5) < 0.05;
  };
  await Promise.all([pushBox(page), until(feelsHalf, 'half of the force felt')]);
  await screenshot(page, 'time-slowed');
  await page.mouse.up();
  await until(() => !world.state.isEngaged, 'the clutch open');
  await page.click('#faster');
  await isAt(1);
  assert.deepEqual(seen.errors, []);
});

test('keys move the tool while Space is held, and hold stops it', limit, async () => {
  const { page } = await stage.open();
  await loaded(page);
  const before = world.state.hip;
  await page.locator('#stage canvas').focus();
  await page.keyboard.down('PageUp');
  await page.waitForTimeout(200);
  assert.ok(distance(world.state.hip, before) < 2e-5, 'without Space nothing moves');
  await page.keyboard.down('Space');
  await until(() => world.state.hip[2] > before[2] + 0.01, 'the tool goes up');
  await page.keyboard.press('h');
  await until(() => world.state.isOnHold, 'hold');
  const stopped = world.state.hip;
  await page.waitForTimeout(600); // longer than a held key takes to the maximum lead
  assert.ok(distance(world.state.hip, stopped) < 2e-5, 'on hold');
  await page.keyboard.press('h');
  await until(() => !world.state.isOnHold, 'resumed');
  await until(() => world.state.hip[2] > stopped[2] + 0.01, 'the same key moves the tool again');
});

test('a second page cannot move the tool of the first, and shows a notice', limit, async () => {
  const first = await stage.open();
  await loaded(first.page);
  await openPanel(first.page);
  await first.page.click('#take');
  await until(() => world.state.isToolTaken, 'the tool taken');
  const { page } = await stage.open();
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state?.isToolTaken);
  assert.equal(await page.evaluate(() => window.__pcavr.state.hasTool), false);
  const before = world.state.hip;
  await grab(page);
  await page.mouse.move(100, 100, { steps: 10 });
  await page.mouse.up();
  const toasts = page.locator('#toasts > div', { hasText: 'Another page controls the tool' });
  await toasts.waitFor();
  await toasts.evaluate((toast) => (toast.title = 'of the pointer'));
  await page.locator('#stage canvas').focus();
  await page.keyboard.down('Space');
  await page.waitForTimeout(300);
  assert.equal(await toasts.count(), 1, 'the same notice is not stacked');
  assert.equal(await toasts.getAttribute('title'), null, 'it is that of the key');
  world.command(4);
  for (let i = 0; i < 20; ++i) {
    world.tool([0.1 * i, 0, 0.5], i > 0);
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  await until(() => world.notices.some((n) => /another page/i.test(n.text)), 'a notice');
  assert.ok(distance(world.state.hip, before) < 2e-5);
  world.command(5); // no longer asks: it would get the tool of the closed page
  await first.page.close();
  await until(() => !world.state.isToolTaken, 'the tool released by the closed page');
  await page.waitForTimeout(300);
  assert.equal(world.state.isToolTaken, false, 'a refused key does not take the tool later');
  await page.keyboard.up('Space');
  await page.waitForTimeout(100); // some frames
  await page.keyboard.down('Space');
  await until(() => world.state.isToolTaken, 'the tool taken by a new key press');
});
