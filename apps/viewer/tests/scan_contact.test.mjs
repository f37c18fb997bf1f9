// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A body that is pushed against what was scanned, in the real server, as the page draws it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded } from './support/drawn.mjs';
import { until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const maxDepth = 0.003; // [m] 2 mm, and the noise of the simulated camera's surface
const speed = 0.15; // [m/s]
const offset = 0.008; // [m] of the push beside the body's centre: it turns

let world;
const stage = setStage(
  {
    world: true,
    images: ['--frames-per-second', '4', '--duration', '6'],
    serverArguments: ({ scene, parameters }) => [scene, '--parameters', parameters],
  },
  () => ({ world } = stage),
);

/// Watches how deep scanned points are in bodies, of those that were in none at first; returns the
/// points [m] in base that stand higher than 30 mm above the table, beside the bodies.
function watchDepth(page) {
  return page.evaluate(() => {
    const { app } = window.__pcavr;
    const { view } = app;
    const points = [];
    view.layers.group('mesh').traverse((part) => {
      const places = part.isMesh && part.visible && part.geometry.attributes.position;
      for (let i = 0; places && i < places.count; ++i) {
        const point = app.camera.position.clone().fromBufferAttribute(places, i);
        points.push(app.base.worldToLocal(part.localToWorld(point)));
      }
    });
    const boxes = view.bodies.map((body) => {
      const { geometry } = body.solid.children.find((child) => child.isMesh);
      geometry.computeBoundingBox();
      return geometry.boundingBox;
    });
    const depthIn = (body, box, point) => {
      const p = point.clone().sub(body.solid.position);
      p.applyQuaternion(body.solid.quaternion.clone().invert());
      const [a, b] = [p.clone().sub(box.min), box.max.clone().sub(p)];
      return Math.min(a.x, a.y, a.z, b.x, b.y, b.z);
    };
    const deepest = (point) =>
      Math.max(...view.bodies.map((body, i) => depthIn(body, boxes[i], point)));
    const outside = points.filter((point) => deepest(point) < 0);
    window.__depth = 0;
    app.onFrame(() => {
      for (const point of outside) window.__depth = Math.max(window.__depth, deepest(point));
    });
    const table = Math.max(
      ...view.model.support_planes.flatMap(({ outline }) => outline.map((p) => p[2])),
    );
    return {
      count: outside.length,
      high: outside.filter((p) => p.z > table + 0.03 && p.z < table + 0.08).map((p) => p.toArray()),
    };
  });
}

/// Moves the tip from one point to another at a speed [m/s].
async function move(from, to, metresPerSecond) {
  const begin = performance.now();
  const way = Math.hypot(...from.map((value, i) => to[i] - value));
  for (;;) {
    const share = Math.min(1, ((performance.now() - begin) / 1000) * (metresPerSecond / way));
    world.tool(
      from.map((value, i) => value + share * (to[i] - value)),
      true,
    );
    if (share === 1) return;
    await new Promise((resolve) => setTimeout(resolve, 4));
  }
}

test(
  'a body pushed beside its centre is held by what was scanned, and that is said',
  limit,
  async () => {
    const { page, seen } = await stage.open();
    await loaded(page);
    const { count, high } = await watchDepth(page);
    assert.ok(count > 5000 && high.length > 20, `${count} points, ${high.length} high`);
    // Of all bodies and scanned things the pair that is nearest.
    const pairs = world.state.objects.flatMap(({ position: [x, y] }, body) =>
      high.map((p) => ({ body, goal: p, way: Math.hypot(p[0] - x, p[1] - y) })),
    );
    const { body, goal, way } = pairs.reduce((a, b) => (b.way < a.way ? b : a));
    const [x, y, z] = world.state.objects[body].position;
    const along = [(goal[0] - x) / way, (goal[1] - y) / way];
    const at = (distance) => [
      x + along[0] * distance - along[1] * offset,
      y + along[1] * distance + along[0] * offset,
      z,
    ];
    const start = [...at(-0.2).slice(0, 2), world.state.hip[2]];
    world.command(4); // take
    await move(world.state.hip, start, 0.3);
    await move(start, at(-0.2), 0.2);
    let wasHeld = false;
    const watch = setInterval(() => {
      wasHeld ||= world.state.objects.some((object) => object.isBlocked || object.isSaturated);
    }, 5);
    const said = page
      .waitForFunction(() =>
        /blocked by the scan|max\. force/.test(document.querySelector('#objects').textContent),
      )
      .then(
        () => true,
        () => false,
      );
    await move(at(-0.2), at(way + 0.1), speed);
    clearInterval(watch);
    assert.ok(wasHeld, 'the server says that the body is held');
    assert.ok(await said, 'the page says that the body is held');
    await screenshot(page, 'scan-contact');
    const depth = await page.evaluate(() => window.__depth);
    assert.ok(depth < maxDepth, `a scanned point is ${1000 * depth} mm inside a body`);
    const moved = world.state.objects[body].position;
    assert.ok(Math.hypot(moved[0] - x, moved[1] - y) > 0.01, 'the body was pushed');
    assert.deepEqual(seen.errors, []);
  },
);
