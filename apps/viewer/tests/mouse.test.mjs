// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { picture } from './support/browser.mjs';
import { drawnBodies, loaded, onScreen, openPanel } from './support/drawn.mjs';
import { distance, until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const sameAsWorld = 1e-4; // [m]

let world;
const stage = setStage({ world: true }, () => ({ world } = stage));

/// Leads the pointer in small steps to where a place in base is drawn.
async function dragTo(page, place) {
  const { x, y } = await onScreen(page, place);
  await page.mouse.move(x, y, { steps: 25 });
}

async function grab(page) {
  const box = await page.locator('#handle').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
}

test(
  'a dragged handle pushes a box, and the picture shows what the world says',
  limit,
  async () => {
    const { page, seen } = await stage.open();
    await loaded(page);
    await page.locator('#handle').waitFor();
    const [x, y, z] = world.state.objects[0].position;
    const tool = world.state.proxy;
    // Beside the box at the height at which the tool is, down with Shift, then along.
    await grab(page);
    await dragTo(page, [x - 0.22, y, tool[2]]);
    await page.keyboard.down('Shift');
    await dragTo(page, [x - 0.22, y, z]);
    await page.keyboard.up('Shift');
    await until(() => Math.abs(world.state.proxy[2] - z) < 0.03, 'the tool beside the box');
    await dragTo(page, [x + 0.02, y, z]);
    await picture(page, 'mouse-pushing');
    await until(() => world.state.objects[0].position[0] > x + 0.03, 'the box pushed');
    await page.mouse.up();
    await until(() => !world.state.isEngaged, 'the tool let go');
    await until(() => world.state.objects[0].speed < 1e-4, 'the box at rest');
    await until(async () => {
      const bodies = await drawnBodies(page);
      return distance(bodies[0].position, world.state.objects[0].position) < sameAsWorld;
    }, 'the drawn box where the world has it');
    assert.deepEqual(seen.errors, []);
    await page.close();
  },
);

test('keys move the tool while Space is held, and hold freezes it', limit, async () => {
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
  const held = world.state.hip;
  await page.waitForTimeout(600); // longer than a held key takes to the end of its reach
  assert.ok(distance(world.state.hip, held) < 2e-5, 'on hold');
  await page.keyboard.press('h');
  await until(() => !world.state.isOnHold, 'go on');
  await until(() => world.state.hip[2] > held[2] + 0.01, 'the tool goes on, by the same key');
});

test('a second page cannot move the tool of the first, and is told so', limit, async () => {
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
  await page.locator('#toasts', { hasText: 'Another page has the tool' }).waitFor();
  await page.locator('#stage canvas').focus();
  await page.keyboard.down('Space');
  await page.waitForTimeout(300);
  const told = page.locator('#toasts > div', { hasText: 'Another page has the tool' });
  assert.equal(await told.count(), 2, 'once for the pointer, once for the key');
  world.command(4);
  for (let i = 0; i < 20; ++i) {
    world.tool([0.1 * i, 0, 0.5], i > 0);
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  await until(() => world.notices.some((n) => /another page/i.test(n.text)), 'a word');
  assert.ok(distance(world.state.hip, before) < 2e-5);
  await first.page.close();
  await until(() => !world.state.isToolTaken, 'the tool given back by a page that is closed');
  await page.waitForTimeout(300);
  assert.equal(world.state.isToolTaken, false, 'a key that was held in vain takes nothing later');
  await page.keyboard.up('Space');
  await page.waitForTimeout(100); // some frames
  await page.keyboard.down('Space');
  await until(() => world.state.isToolTaken, 'the tool taken by the key pressed anew');
});
