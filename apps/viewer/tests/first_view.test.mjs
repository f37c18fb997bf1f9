// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { loaded, onScreen } from './support/drawn.mjs';
import { until } from './support/live.mjs';
import { limit, setStage } from './support/stage.mjs';

const sizes = [
  [1920, 1080],
  [1280, 800],
  [1024, 768],
  [768, 1024],
  [390, 844],
];

let world;
const stage = setStage({ world: true }, () => ({ world } = stage));

async function openAt(width, height) {
  const { page, seen } = await stage.open();
  await page.setViewportSize({ width, height });
  await loaded(page);
  await page.locator('#handle').waitFor();
  await page.waitForTimeout(200); // some frames after the last change of size
  return { page, seen };
}

/// The centres of the tool and of all bodies, and the corners of bodies and supports, in base.
function whatMatters(page) {
  return page.evaluate(() => {
    const { view } = window.__pcavr.app;
    const points = view.model.support_planes.flatMap(({ outline }) => outline);
    points.push(view.tool.proxy.position.toArray());
    for (const body of view.bodies) {
      const meshes = body.solid.children.filter((child) => child.isMesh);
      for (const { geometry } of meshes) {
        geometry.computeBoundingBox();
        const { min, max } = geometry.boundingBox;
        for (let i = 0; i < 8; ++i) {
          const corner = min.clone();
          if (i & 1) corner.x = max.x;
          if (i & 2) corner.y = max.y;
          if (i & 4) corner.z = max.z;
          points.push(
            corner.applyQuaternion(body.solid.quaternion).add(body.solid.position).toArray(),
          );
        }
      }
    }
    return points;
  });
}

async function assertAllInStage(page, what) {
  const box = await page.locator('#stage').boundingBox();
  const points = await whatMatters(page);
  assert.ok(points.length > 16, `${points.length} points`);
  let widest = 0;
  for (const point of points) {
    const { x, y } = await onScreen(page, point);
    const isIn = x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
    assert.ok(isIn, `${what}: ${point} is drawn at ${x}, ${y}`);
    const across = Math.abs(x - box.x - box.width / 2) / (box.width / 2);
    const up = Math.abs(y - box.y - box.height / 2) / (box.height / 2);
    widest = Math.max(widest, across, up);
  }
  assert.ok(widest > 0.7, `${what}: the scene fills ${widest} of the stage`);
}

test('the first view has all bodies, the table and the tool at every size', limit, async () => {
  for (const [width, height] of sizes) {
    const { page, seen } = await openAt(width, height);
    await assertAllInStage(page, `${width} x ${height}`);
    await screenshot(page, `first-view-${width}x${height}`);
    assert.deepEqual(seen.errors, []);
    await page.close();
  }
});

/// Looks so that a body's label would be at the tool's ring.
function lookPastTheTool(page) {
  return page.evaluate(() => {
    const { app } = window.__pcavr;
    const [body] = app.view.bodies;
    const top = body.solid.getWorldPosition(app.camera.position.clone());
    top.y += 0.06;
    const tool = app.view.tool.proxy.getWorldPosition(top.clone());
    app.camera.position.copy(tool).addScaledVector(tool.clone().sub(top).normalize(), 0.6);
    app.camera.lookAt(tool);
    app.invalidate();
  });
}

/// What is written or drawn over the scene, on the page.
function areasOnScene(page) {
  return page.evaluate(() =>
    [
      ...document.querySelectorAll(
        '#labels > span, #handle, #height-handle, #call-to-action, #status-lines',
      ),
    ]
      .filter((element) => !element.hidden)
      .map((element) => {
        const { left, right, top, bottom } = element.getBoundingClientRect();
        return { name: element.textContent.trim() || element.id, left, right, top, bottom };
      }),
  );
}

function assertApart(areas, what) {
  assert.ok(areas.length >= 5, `${areas.length} areas`);
  for (const a of areas)
    for (const b of areas.slice(areas.indexOf(a) + 1)) {
      const isApart =
        a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
      const isPair = a.name === 'handle' && b.name === 'Drag the ring to push';
      assert.ok(isApart || isPair, `${what}: ${a.name}, ${b.name}`);
    }
}

test('labels, ring and call to action do not overlap at any size', limit, async () => {
  for (const [width, height] of sizes) {
    const { page } = await openAt(width, height);
    assertApart(await areasOnScene(page), `${width} x ${height}`);
    await lookPastTheTool(page);
    await page.waitForTimeout(200);
    assertApart(await areasOnScene(page), `${width} x ${height}, past the tool`);
    await screenshot(page, `labels-${width}x${height}`);
    await page.close();
  }
});

test('beside a scroll bar of 15 pixels the panel has room for its layers', limit, async () => {
  const { page } = await openAt(1280, 800);
  const wide = await page.evaluate(() => {
    const panel = document.querySelector('#panel');
    const layers = document.querySelector('#layers');
    panel.style.width = `${panel.offsetWidth - 15}px`;
    return [panel.scrollWidth - panel.clientWidth, layers.scrollWidth - layers.clientWidth];
  });
  assert.deepEqual(wide, [0, 0]);
});

test(
  'a window that changes its shape keeps all in view until the user turns it',
  limit,
  async () => {
    const { page } = await openAt(1280, 800);
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(300);
    await assertAllInStage(page, 'made narrow');
    await page.locator('#view').focus();
    await page.keyboard.press('j', { delay: 100 });
    const eye = () => page.evaluate(() => window.__pcavr.app.camera.position.toArray());
    const chosen = await eye();
    await page.setViewportSize({ width: 1280, height: 800 });
    await page.waitForTimeout(300);
    assert.deepEqual(await eye(), chosen);
  },
);

test('in a narrow window the panel is a sheet, pulled up and down by its grip', limit, async () => {
  const { page } = await openAt(390, 844);
  const panel = page.locator('#panel');
  assert.equal(await panel.isVisible(), false);
  const pull = async (by) => {
    const { x, y, width, height } = await page.locator('#sheet-grip').boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2, y + height / 2 + by, { steps: 4 });
    await page.mouse.up();
    await page.waitForTimeout(200);
  };
  await pull(-80);
  assert.equal(await panel.isVisible(), true);
  await assertAllInStage(page, 'above the sheet');
  await screenshot(page, 'first-view-sheet');
  await pull(80);
  assert.equal(await panel.isVisible(), false);
  await page.click('#sheet-grip');
  assert.equal(await panel.isVisible(), true);
});

test('the scene says what to do first, until the first push', limit, async () => {
  const { page } = await openAt(1280, 800);
  const call = page.locator('#call-to-action');
  assert.equal(await call.textContent(), 'Drag the ring to push');
  await call.waitFor();
  const ring = await page.locator('#handle').boundingBox();
  const box = await call.boundingBox();
  assert.ok(Math.abs(box.x + box.width / 2 - ring.x - ring.width / 2) < 3, 'above the ring');
  assert.ok(box.y + box.height <= ring.y + 2, 'the ring is free');
  const { proxy, objects } = world.state;
  const toTool = ({ position }) => Math.hypot(...position.map((value, i) => value - proxy[i]));
  const [body] = [...objects].sort((a, b) => toTool(a) - toTool(b));
  await page.mouse.move(ring.x + ring.width / 2, ring.y + ring.height / 2);
  await page.mouse.down();
  assert.equal(await call.isVisible(), true, 'before the push');
  const at = await onScreen(page, [body.position[0], body.position[1], proxy[2]]);
  await page.mouse.move(at.x, at.y, { steps: 20 });
  await call.waitFor({ state: 'hidden' });
  await page.mouse.up();
  await page.waitForTimeout(200);
  assert.equal(await call.isVisible(), false);
  world.command(3);
  await page.close();
  await until(() => !world.state.isToolTaken, 'the tool released');
});

test('each control of the tool has a sentence on hover', limit, async () => {
  const { page } = await openAt(1280, 800);
  const buttons = await page
    .locator('#tool-section button')
    .evaluateAll((all) =>
      all.map((button) => ({ text: button.textContent.trim(), title: button.title })),
    );
  assert.deepEqual(
    buttons.map(({ text }) => text),
    [
      'Use the tool',
      'Let go',
      'Move with keys',
      'Pause',
      '−',
      '+',
      'Start over',
      'Undo',
      'Record session',
    ],
  );
  for (const { text, title } of buttons) assert.match(title, /^[A-Z].{20,}\.$/, text);
});

test('what stands between eye and tool is see-through', limit, async () => {
  const { page } = await openAt(1280, 800);
  // The tool behind the first body, seen through its middle; then no tool.
  const shares = await page.evaluate(() => {
    const { app } = window.__pcavr;
    const { view, renderer, camera, scene, base } = app;
    const body = view.bodies[0];
    const at = body.solid.position.clone();
    const behind = at.clone();
    behind.x += 0.4;
    const eye = at.clone();
    eye.x -= 0.5;
    eye.z += 0.02;
    camera.position.copy(base.localToWorld(eye));
    camera.lookAt(base.localToWorld(behind.clone()));
    camera.updateMatrixWorld(true);
    const gl = renderer.getContext();
    const size = 12;
    const shareOfBody = () => {
      renderer.render(scene, camera);
      const pixels = new Uint8Array(4 * size * size);
      const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
      gl.readPixels(
        (width - size) / 2,
        (height - size) / 2,
        size,
        size,
        gl.RGBA,
        gl.UNSIGNED_BYTE,
        pixels,
      );
      let blue = 0;
      for (let i = 0; i < pixels.length; i += 4) if (pixels[i + 2] > 1.5 * pixels[i]) ++blue;
      return blue / (size * size);
    };
    view.tool.show(behind.toArray(), behind.toArray(), [0, 0, 0]);
    const withTool = shareOfBody();
    view.tool.hide();
    return { withTool, without: shareOfBody() };
  });
  assert.equal(shares.without, 1, 'the body hides what is behind it');
  assert.ok(shares.withTool > 0.1 && shares.withTool < 0.4, `${shares.withTool} of it is drawn`);
});
