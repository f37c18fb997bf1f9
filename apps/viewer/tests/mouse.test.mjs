// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { drawnBodies, loaded, onScreen, openPanel } from './support/drawn.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const poseTolerance = 1e-4; // [m]

let world;
let box; // the index of the object beside which the tool starts
const stage = setStage({ world: true }, () => {
  ({ world } = stage);
  box = nearestObject();
});

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

/// As the page says: drags the ring against the body beside it. The pointer stays down.
async function pushBox(page) {
  await page.locator('#handle').waitFor();
  const start = world.state.objects[box].position;
  await grab(page);
  await dragTo(page, [start[0], start[1], world.state.proxy[2]]);
  await screenshot(page, 'mouse-pushing');
  await until(() => distance(world.state.objects[box].position, start) > 0.03, 'the box pushed');
}

/// The index of the object that is the nearest to the tool.
function nearestObject() {
  const distances = world.state.objects.map(({ position }) =>
    distance(position, world.state.proxy),
  );
  return distances.indexOf(Math.min(...distances));
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
      .locator('.plot svg text', { hasText: `${world.welcome.objects[box]} breaks away` })
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
    await until(() => world.state.objects[box].speed < 1e-4, 'the box at rest');
    await until(async () => {
      const bodies = await drawnBodies(page);
      return distance(bodies[box].position, world.state.objects[box].position) < poseTolerance;
    }, 'the drawn box at its pose in the world');
    await saveLastPush(page, world.welcome.objects[box]);
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

/// The plot has the object's name, and its table absolute times, phases and components.
async function saveLastPush(page, name) {
  await page.setViewportSize({ width: 1280, height: 800 });
  const plot = page.locator('.plot', { hasText: `Force on the hand, from ${name}` });
  await plot.getByRole('button', { name: 'x y z' }).click();
  await screenshot(page, 'mouse-plot');
  const saving = page.waitForEvent('download');
  await plot.getByRole('button', { name: 'CSV' }).click();
  const text = readFileSync(await (await saving).path(), 'utf8');
  const [head, ...rows] = text.trimEnd().split('\r\n');
  assert.equal(
    head,
    'time of the world (s),time since 1970 (s),object,phase,on the hand (N),x (N),y (N),z (N)',
  );
  const sliding = rows.map((row) => row.split(',')).filter(([, , , phase]) => phase === 'sliding');
  const [, clock, object, , force, ...components] = sliding[0];
  assert.ok(Math.abs(Number(clock) - Date.now() / 1000) < 20, clock);
  assert.equal(object, name);
  assert.ok(Math.abs(Math.hypot(...components) - force) < 1e-6, `${sliding[0]}`);
}

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

test('the view follows the tool, but not while the mouse drags it', limit, async () => {
  const { page, seen } = await stage.open();
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  const offCentre = () =>
    page.evaluate(() => {
      const { app } = window.__pcavr;
      const tool = app.view.tool.proxy.getWorldPosition(app.camera.position.clone());
      const { x, y } = tool.project(app.camera);
      return Math.hypot(x, y);
    });
  const eye = () => page.evaluate(() => window.__pcavr.app.camera.position.toArray());
  await page.locator('#handle').waitFor();
  await page.getByRole('button', { name: 'Follow tool' }).click();
  await until(async () => (await offCentre()) < 0.02, 'the tool in the middle');
  await grab(page);
  await until(() => world.state.isEngaged, 'the clutch closed');
  const [before, [x, y, z]] = [await eye(), world.state.proxy];
  const target = [x - 0.1, y, z];
  await dragTo(page, target);
  await until(() => distance(world.state.hip, target) < 0.02, 'the tool at the pointer');
  assert.deepEqual(await eye(), before);
  await page.mouse.up();
  await until(async () => (await offCentre()) < 0.02, 'the tool in the middle again');
  assert.ok(distance(world.state.hip, target) < 0.02, 'the tool where it was dragged to');
  assert.deepEqual(seen.errors, []);
  await page.close();
});

test('starting over can be undone until a body is touched', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await openPanel(page);
  const undo = page.locator('#undo-reset');
  const position = () => world.state.objects[box].position;
  const isAt = (point) => distance(position(), point) < poseTolerance;
  await page.click('#reset');
  await undo.waitFor();
  const start = position();
  await pushBox(page);
  await undo.waitFor({ state: 'hidden' });
  await page.mouse.up();
  await until(() => !world.state.isEngaged, 'the clutch open');
  await until(() => world.state.objects[box].speed < 1e-4, 'the box at rest');
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
    return distance(bodies[box].position, position()) < poseTolerance;
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
    const onBox = Math.hypot(...world.state.objects[box].force);
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
