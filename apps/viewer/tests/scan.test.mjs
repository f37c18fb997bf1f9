// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A body that is pushed into what the scan shows, on the real server and page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { deepest, halfEdges, putCup } from './support/cup.mjs';
import { loaded, openPanel } from './support/drawn.mjs';
import { Live, until } from './support/live.mjs';
import { setStage } from './support/stage.mjs';

const limit = { timeout: 120_000 };
const maxDepth = 0.002; // [m] of a scan point inside a body; this scan has no noise
const cup = { radius: 0.04, height: 0.1 }; // [m]
const gap = 0.06; // [m] between box and cup

let half; // its half edges [m]
let scan; // vertices of the scanned cup [m]
const stage = setStage({
  serverArguments: ({ recording, scene, parameters }) => {
    const manifest = readFileSync(join(scene, 'scene.yaml'), 'utf8');
    const [x, y] = manifest
      .match(/name: box_1[^]*?pose: {t: \[([^\]]*)\]/)[1]
      .split(',')
      .map(Number);
    half = halfEdges(join(recording, 'objects', 'box_1.obj'));
    scan = putCup(scene, [x, y + half[1] + cup.radius + gap], cup.radius, cup.height);
    return [scene, '--parameters', parameters];
  },
});

/// Pushes the box at `speed` [m/s] towards the cup, `offset` [m] beside its middle, until the hand is 0.1 m past
/// where the box meets the cup. `whileHeld` runs with the hand there. Returns what the states showed: the depth of the
/// deepest scan point [m], how far the box moved [m], and if it was said to be held.
async function push(speed, offset, whileHeld = async () => {}) {
  const live = new Live(stage.server.url);
  await until(() => live.state, 'a state');
  live.command(4); // take
  await until(() => live.state.hasTool, 'the tool');
  const { cycles } = live.state;
  live.command(3); // start over
  await until(() => live.state.cycles < cycles || live.state.cycles > cycles + 100, 'a new start');
  const [x, y, z] = live.state.objects[0].position;
  const seen = { depth: -Infinity, moved: 0, isHeld: false };
  live.onState = ({ objects: [box] }) => {
    seen.depth = Math.max(seen.depth, deepest(scan, box, half));
    seen.moved = box.position[1] - y;
    seen.isHeld ||= box.isBlocked || box.isSaturated;
  };
  const low = [x + offset, y - half[1] - 0.08, z];
  const end = [low[0], y - half[1] + gap + 0.1, z];
  await live.moveToolOver(low);
  await live.moveTool(low, end, (end[1] - low[1]) / speed);
  await whileHeld(live, end);
  live.close();
  return seen;
}

/// The scan stops the box where it meets the cup, and the states say so.
function assertHeld({ depth, moved, isHeld }) {
  assert.ok(depth < maxDepth, `a scan point is ${depth} m inside the box`);
  assert.ok(moved > 0.5 * gap && moved < gap + 0.03, `the box moved by ${moved} m`);
  assert.ok(isHeld, 'said to be held');
}

test('a scanned cup holds a box that is pushed beside its middle', limit, async (t) => {
  const seen = await push(0.5, 0.03, (live, end) => live.moveTool(end, end, 0.5));
  t.diagnostic(`deepest scan point ${(1000 * seen.depth).toFixed(2)} mm inside the box`);
  assertHeld(seen);
});

test('a page says that a box is held by the scan', limit, async () => {
  const { page, seen } = await stage.open();
  await loaded(page);
  await openPanel(page);
  const held = page.locator('#objects', { hasText: /box_1.*(max\. force|blocked by the scan)/s });
  const states = await push(0.15, -0.03, async (live, end) => {
    const waiting = held.waitFor().then(() => (live.isShown = true));
    while (!live.isShown && !live.isClosed) await live.moveTool(end, end, 0.1);
    await waiting;
    await screenshot(page, 'scan-holds-box');
  });
  assertHeld(states);
  assert.deepEqual(seen.errors, []);
});
