// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a newcomer does by the page's words: drags the ring towards a body, drags a body, presses arrow
// keys. No key that the prompt does not name is pressed.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded, onScreen } from './support/drawn.mjs';
import { distance, Live, until } from './support/live.mjs';
import { makeScene, serve } from './support/pcavr.mjs';

const limit = { timeout: 120_000 }; // [ms]
const minPush = 0.01; // [m]
const seeds = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];

let browser;

before(async () => (browser = await openBrowser()), limit);
afterEach(() => browser?.closePages());
after(() => browser?.close());

/// Opens a served scene of `simulate push` at a window size, runs `act`, and closes all.
async function inScene(seed, size, act) {
  const scene = makeScene(() => {}, ['--no-images'], seed);
  const server = await serve(scene.scene, '--parameters', scene.parameters);
  const world = new Live(server.url);
  try {
    await until(() => world.state, 'the first state');
    const { page, seen } = await openPage(browser.context, server.url);
    await page.setViewportSize(size);
    await loaded(page);
    await page.locator('#call-to-action', { hasText: 'Drag the ring to push' }).waitFor();
    await page.waitForTimeout(200); // some frames after the last change of size
    await act(page, world);
    assert.deepEqual(seen.errors, []);
    await page.close();
  } finally {
    world.close();
    await server.stop();
    scene.remove();
  }
}

/// The index of the object that is the nearest to the tool.
function nearest({ objects, proxy }) {
  const distances = objects.map(({ position }) => distance(position, proxy));
  return distances.indexOf(Math.min(...distances));
}

async function centerOf(page, selector) {
  const { x, y, width, height } = await page.locator(selector).boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
}

/// Where the body is drawn: a newcomer drags towards what is seen.
const drawnAt = (page, world, body) => onScreen(page, world.state.objects[body].position);

async function dragWithMouse(page, from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 30 });
  await page.waitForTimeout(300);
  await page.mouse.up();
}

async function dragWithFinger(page, from, to) {
  const session = await page.context().newCDPSession(page);
  const touch = (type, point) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: point ? [point] : [] });
  await touch('touchStart', from);
  for (let i = 1; i <= 30; ++i) {
    const at = (a, b) => a + ((b - a) * i) / 30;
    await touch('touchMove', { x: at(from.x, to.x), y: at(from.y, to.y) });
    await page.waitForTimeout(16);
  }
  await page.waitForTimeout(300);
  await touch('touchEnd');
}

/// Over before the tool can be at the body.
async function flickWithMouse(page, from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 2 });
  await page.mouse.up();
}

async function assertPushed(world, body, start, what) {
  const moved = () => distance(world.state.objects[body].position, start);
  await until(() => moved() > minPush, `${what}: the body is pushed`, 5000);
}

const ways = [
  { name: 'mouse', size: { width: 1280, height: 800 }, drag: dragWithMouse },
  { name: 'touch', size: { width: 390, height: 844 }, drag: dragWithFinger },
];

for (const { name, size, drag } of ways)
  for (const seed of name === 'mouse' ? seeds : seeds.slice(0, 3))
    test(`the first drag of the ring by ${name} pushes a body of scene ${seed}`, limit, () =>
      inScene(seed, size, async (page, world) => {
        const body = nearest(world.state);
        const start = world.state.objects[body].position;
        await screenshot(page, `first-drag-${name}-${seed}`);
        await drag(page, await centerOf(page, '#handle'), await drawnAt(page, world, body));
        await assertPushed(world, body, start, name);
      }),
    );

test('the first drag by arrow keys pushes a body', limit, () =>
  inScene(1, ways[0].size, async (page, world) => {
    const body = nearest(world.state);
    const start = world.state.objects[body].position;
    const ring = await centerOf(page, '#handle');
    const at = await drawnAt(page, world, body);
    const isAcross = Math.abs(at.x - ring.x) > Math.abs(at.y - ring.y);
    const key = isAcross
      ? at.x > ring.x
        ? 'ArrowRight'
        : 'ArrowLeft'
      : at.y < ring.y
        ? 'ArrowUp'
        : 'ArrowDown';
    await page.locator('#view').focus();
    await page.keyboard.down('Space');
    await page.keyboard.down(key);
    await assertPushed(world, body, start, key);
    await page.keyboard.up(key);
    await page.keyboard.up('Space');
  }),
);

const waysOfBodies = [...ways, { name: 'flick', size: ways[0].size, drag: flickWithMouse }];

for (const { name, size, drag } of waysOfBodies)
  test(`a body dragged by ${name} goes where the pointer goes`, limit, () =>
    inScene(2, size, async (page, world) => {
      const body = nearest(world.state);
      const start = world.state.objects[body].position;
      const from = await drawnAt(page, world, body);
      const goal = [start[0], start[1] + 0.12, start[2]];
      await drag(page, from, await onScreen(page, goal));
      const along = () => world.state.objects[body].position[1] - start[1];
      await until(() => along() > minPush, `${name}: the body goes along the drag`, 5000);
      await screenshot(page, `drag-body-${name}`);
    }),
  );

test('two drags that touch nothing are explained', limit, () =>
  inScene(1, ways[0].size, async (page, world) => {
    const height = await centerOf(page, '#height-handle');
    await dragWithMouse(page, height, { x: height.x, y: height.y - 150 });
    const body = nearest(world.state);
    const ring = await centerOf(page, '#handle');
    await dragWithMouse(page, ring, { x: ring.x + 60, y: ring.y });
    const name = world.welcome.objects[body];
    const text = page.locator('#call-to-action', {
      hasText: new RegExp(`cm (above|before) ${name}`),
    });
    await text.waitFor();
    await screenshot(page, 'miss-explained');
  }),
);
