// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { after, test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { closeClutch, flick, frames, press } from './support/controller.mjs';
import { enterVr } from './support/headset.mjs';
import { until } from './support/live.mjs';
import { serve } from './support/pcavr.mjs';
import { startRelay } from './support/relay.mjs';
import { limit, sceneArguments, setStage } from './support/stage.mjs';

const maxSignDelay = 300; // [ms]

let world;
const stage = setStage({ headset: true, world: true }, () => ({ world } = stage));
const servers = [];
after(() => Promise.all(servers.map((server) => server.signal('SIGKILL') && server.ended)));

/// Pitches the head by 20 degrees, and puts the hands in front of it.
async function lookDown(page) {
  await page.evaluate(() => {
    const half = (-10 * Math.PI) / 180;
    window.__headset.quaternion.set(Math.sin(half), 0, 0, Math.cos(half));
    window.__headset.controllers.left.position.set(-0.2, 1.25, -0.4);
    window.__headset.controllers.right.position.set(0.2, 1.25, -0.4);
  });
  await frames(page, 4);
}

/// For each eye and body the largest coordinate of a corner of its box on the picture; 1: its edge.
function reachOfBodies(page) {
  return page.evaluate(() => {
    const { app } = window.__pcavr;
    return app.renderer.xr.getCamera().cameras.flatMap((eye) =>
      app.view.bodies.map((body) => {
        const mesh = body.solid.children.find((child) => child.isMesh);
        mesh.geometry.computeBoundingBox();
        const { min, max } = mesh.geometry.boundingBox;
        let reach = 0;
        for (let i = 0; i < 8; ++i) {
          const corner = min.clone();
          if (i & 1) corner.x = max.x;
          if (i & 2) corner.y = max.y;
          if (i & 4) corner.z = max.z;
          body.solid.localToWorld(corner).applyMatrix4(eye.matrixWorldInverse);
          if (corner.z > 0) return Infinity;
          corner.applyMatrix4(eye.projectionMatrix);
          reach = Math.max(reach, Math.abs(corner.x), Math.abs(corner.y));
        }
        return reach;
      }),
    );
  });
}

/// For each eye the largest coordinate of a corner of the panel or its stop button on the picture.
function reachOfPanel(page) {
  return page.evaluate(() => {
    const { app, vr } = window.__pcavr;
    const sheets = [vr.panel.mesh, vr.panel.mesh.getObjectByName('emergency-stop')];
    return app.renderer.xr.getCamera().cameras.map((eye) => {
      let reach = 0;
      for (const sheet of sheets) {
        const places = sheet.geometry.attributes.position;
        for (let i = 0; i < places.count; ++i) {
          const corner = sheet.position.clone().fromBufferAttribute(places, i);
          sheet.localToWorld(corner).applyMatrix4(eye.matrixWorldInverse);
          corner.applyMatrix4(eye.projectionMatrix);
          reach = Math.max(reach, Math.abs(corner.x), Math.abs(corner.y));
        }
      }
      return reach;
    });
  });
}

test(
  'on entering, a head pitched 20 degrees down has bodies and panel in both eyes',
  limit,
  async () => {
    const { page, seen } = await enterVr(stage);
    await lookDown(page);
    const reach = await reachOfBodies(page);
    assert.equal(reach.length, 4);
    for (const value of reach) assert.ok(value < 0.9, `${reach}`);
    const panel = await reachOfPanel(page);
    assert.equal(panel.length, 2);
    for (const value of panel) assert.ok(value < 1, `panel and stop button: ${panel}`);
    await screenshot(page, 'vr-entering');
    assert.deepEqual(seen.errors, []);
  },
);

/// For each eye and label: whether it is in the picture, and how far its lower edge is above the
/// body's centre [pictures].
function labelsInEyes(page) {
  return page.evaluate(() => {
    const { app, vr } = window.__pcavr;
    const { mesh, texts } = vr.labels;
    const places = mesh.geometry.attributes.position;
    return app.renderer.xr.getCamera().cameras.flatMap((eye) => {
      const onPicture = (point) =>
        point.applyMatrix4(eye.matrixWorldInverse).applyMatrix4(eye.projectionMatrix);
      return texts.map((text, i) => {
        const body = app.view.bodies.find(({ object }) => text.startsWith(`${object.name} · `));
        const corners = [0, 1, 2, 3].map((corner) => {
          const point = body.solid.position.clone().fromBufferAttribute(places, 4 * i + corner);
          return onPicture(mesh.localToWorld(point));
        });
        const centre = onPicture(body.solid.getWorldPosition(corners[0].clone()));
        const isIn = corners.every(({ x, y }) => Math.abs(x) < 1 && Math.abs(y) < 1);
        const isCentred = corners[0].x < centre.x && corners[1].x > centre.x;
        return { text, isIn, isCentred, above: (corners[0].y - centre.y) / 2 };
      });
    });
  });
}

test('each body has its name and phase above it in both eyes', limit, async () => {
  const { page } = await enterVr(stage);
  await lookDown(page);
  const labels = await labelsInEyes(page);
  assert.deepEqual(
    labels.map(({ text }) => text),
    ['box_1 · free', 'box_2 · free', 'box_1 · free', 'box_2 · free'],
  );
  for (const { text, isIn, isCentred, above } of labels)
    assert.ok(isIn && isCentred && above > 0 && above < 0.2, `${text} is ${above} above the body`);
  await page.close();
});

test('a card names each control until it was used', limit, async () => {
  const { page } = await enterVr(stage);
  await lookDown(page);
  const cards = () =>
    page.evaluate(() => ['left', 'right'].map((side) => window.__pcavr.vr.cards.shown(side)));
  assert.deepEqual(await cards(), [
    ['Stick', 'Lower button', 'Upper button'],
    ['Grip or trigger', 'Lower button', 'Upper button'],
  ]);
  await closeClutch(page, world);
  await press(page, 'right', 'squeeze', false);
  await flick(page, 'left', 1, 0);
  await press(page, 'left', 'y-button', true);
  await press(page, 'left', 'y-button', false);
  assert.deepEqual(await cards(), [['Lower button'], ['Lower button', 'Upper button']]);
  for (let i = 0; i < 2; ++i)
    for (const isPressed of [true, false]) await press(page, 'left', 'x-button', isPressed);
  assert.deepEqual(await cards(), [[], ['Lower button', 'Upper button']]);
  await until(() => !world.state.isOnHold, 'continued');
});

test('panel and cards never hide a body, wherever the hands are', limit, async () => {
  const { page } = await enterVr(stage);
  await lookDown(page);
  // A hand on the line of sight to each body.
  for (const body of [0, 1]) {
    await page.evaluate((index) => {
      const { app, vr } = window.__pcavr;
      const { position } = app.view.bodies[index].solid;
      const at = vr.person.toHeadset(position);
      const head = window.__headset.position;
      for (const side of ['left', 'right']) {
        const share = 0.3;
        window.__headset.controllers[side].position.set(
          head.x + share * (at.x - head.x),
          head.y + share * (at.y - head.y) - 0.1,
          head.z + share * (at.z - head.z),
        );
      }
    }, body);
    await frames(page, 4);
    const hidden = await page.evaluate(() => {
      const { app, vr } = window.__pcavr;
      const stop = vr.panel.mesh.getObjectByName('emergency-stop');
      const sheets = [vr.panel.mesh, stop, ...vr.cards.group.children].filter(
        (mesh) => mesh.visible,
      );
      const { x, y, z } = window.__headset.position;
      const names = [];
      for (const sheet of sheets)
        for (const { object, solid } of app.view.bodies) {
          const at = vr.person.toHeadset(solid.position);
          // Where the line from the eyes' middle to the body passes through the sheet's plane.
          const matrix = sheet.matrix.clone();
          if (sheet === stop) matrix.premultiply(vr.panel.mesh.matrix); // its parent
          const toSheet = matrix.invert();
          const head = at.clone().set(x, y, z).applyMatrix4(toSheet);
          const end = at.applyMatrix4(toSheet);
          const t = head.z / (head.z - end.z);
          const hit = head.lerp(end, t);
          sheet.geometry.computeBoundingBox();
          const { max } = sheet.geometry.boundingBox;
          const isHit = Math.abs(hit.x) < max.x && Math.abs(hit.y) < max.y;
          if (t > 0 && t < 1 && isHit) names.push(`${sheet.name} hides ${object.name}`);
        }
      return { names, count: sheets.length };
    });
    assert.equal(hidden.count, 4);
    assert.deepEqual(hidden.names, []);
    for (const value of await reachOfPanel(page))
      assert.ok(value < 1, `${body}: panel at ${value}`);
    await screenshot(page, `vr-clear-${body}`);
  }
});

/// The time until the sign shows a text [ms], measured in the page.
function signAfter(page, text) {
  return page.evaluate(
    (wanted) =>
      new Promise((resolve) => {
        const next = () =>
          window.__pcavr.vr.sign.text === wanted ? resolve(Date.now()) : setTimeout(next, 2);
        next();
      }),
    text,
  );
}

/// Whether the sign has one colour alone along its left and right edges: no letter is cut off.
function hasMargins(page) {
  return page.evaluate(() => {
    const sheet = window.__pcavr.vr.sign.mesh.material.map.image;
    const pen = sheet.getContext('2d');
    const margin = 10;
    const isPlain = (left) => {
      const { data } = pen.getImageData(left, 0, margin, sheet.height);
      return data.every((value, i) => value === data[i % 4]);
    };
    return isPlain(0) && isPlain(sheet.width - margin);
  });
}

async function assertSign(page, text, trigger) {
  const shown = signAfter(page, text);
  const since = Date.now();
  await trigger();
  const delay = (await shown) - since;
  assert.ok(delay < maxSignDelay, `${text} after ${delay} ms`);
  assert.ok(await hasMargins(page), `${text} is not cut off`);
}

test('a sign says within 0.3 s that the world is paused, or the tool in use', limit, async () => {
  const { page } = await enterVr(stage);
  await lookDown(page);
  await assertSign(page, 'PAUSED', () => world.command(1));
  await screenshot(page, 'vr-sign');
  world.command(2);
  await signAfter(page, '');
  world.command(4);
  await until(() => world.state.hasTool, 'the tool taken');
  await page.waitForFunction(() => window.__pcavr.state.isToolTaken);
  await assertSign(page, 'TOOL IN USE', () =>
    page.evaluate(() => window.__headset.controllers.right.updateButtonValue('squeeze', 1)),
  );
  await screenshot(page, 'vr-sign-in-use');
  world.command(5);
  await page.evaluate(() => window.__headset.controllers.right.updateButtonValue('squeeze', 0));
  await signAfter(page, '');
});

test('a sign says within 0.3 s that the server is gone', limit, async () => {
  const server = await serve(...sceneArguments(stage.scene));
  servers.push(server);
  const { page } = await enterVr({ open: () => stage.open(server.url) });
  await lookDown(page);
  await assertSign(page, 'CONNECTION LOST', () => server.signal('SIGSTOP'));
  await screenshot(page, 'vr-sign-lost');
});

test('a sign says within 0.3 s that a body is outside the model', limit, async (t) => {
  let isOutside = false;
  const relay = await startRelay(stage.server.url, (message) => {
    // The first object's flags in a state.
    if (message[5] === 2 && isOutside) message[24 + 104 + 41] |= 1;
    return message;
  });
  t.after(relay.close);
  const { page } = await enterVr({ open: () => stage.open(relay.url) });
  await lookDown(page);
  await assertSign(page, 'OUTSIDE THE MODEL', () => (isOutside = true));
  await screenshot(page, 'vr-sign-outside');
});

/// Touches a button of the panel with the right hand's tip.
async function touch(page, button, withdraws = true) {
  const reach = (depth) =>
    page.evaluate(
      ([name, z]) => {
        const { panel } = window.__pcavr.vr;
        const at = panel.centerOf(name).setZ(z).applyMatrix4(panel.mesh.matrix);
        window.__headset.controllers.right.position.set(at.x, at.y, at.z);
      },
      [button, depth],
    );
  await reach(0.1);
  await frames(page, 3);
  await reach(0.004);
  if (!withdraws) return;
  await frames(page, 3);
  await reach(0.1);
  await frames(page, 3);
}

test('the panel recentres, scales, turns, shows the scan, resets and leaves', limit, async () => {
  const { page } = await enterVr(stage);
  await lookDown(page);
  const person = () =>
    page.evaluate(() => {
      const { rig, scale } = window.__pcavr.vr.person;
      return { matrix: [...rig.matrix.elements], scale };
    });
  const start = await person();
  await touch(page, 'turn');
  assert.notDeepEqual((await person()).matrix, start.matrix);
  await touch(page, 'recentre');
  (await person()).matrix.forEach((value, i) =>
    assert.ok(Math.abs(value - start.matrix[i]) < 1e-5, `${i}`),
  );
  await touch(page, 'scale');
  assert.equal((await person()).scale, 2);
  const layer = () => page.evaluate(() => window.__pcavr.layers.mesh);
  const before = await layer();
  await touch(page, 'scan');
  assert.equal(await layer(), !before);
  const timeScale = () => page.evaluate(() => window.__pcavr.state?.timeScale);
  for (const scale of [0.5, 0.25, 0.1, 1]) {
    await touch(page, 'time');
    await until(async () => (await timeScale()) === scale, `time at ${scale}`);
  }
  // A reset needs a second press.
  const home = world.state.hip[2];
  const raised = world.state.hip.map((value, i) => value + (i === 2 ? 0.05 : 0));
  world.command(4);
  await until(() => world.state.hasTool, 'the tool taken');
  world.tool(world.state.hip, true);
  await until(() => {
    world.tool(raised, true);
    return world.state.hip[2] > home + 0.03;
  }, 'the tool raised');
  world.tool(raised, false);
  world.command(5);
  await until(() => !world.state.isToolTaken, 'the tool released');
  await touch(page, 'reset');
  await page.waitForTimeout(200);
  assert.ok(world.state.hip[2] > home + 0.03, 'asks first');
  await screenshot(page, 'vr-panel');
  await touch(page, 'reset');
  await until(() => Math.abs(world.state.hip[2] - home) < 1e-3, 'the tool where it started');
  await touch(page, 'leave', false);
  await page.waitForFunction(() => !window.__pcavr.vr.isPresenting);
});
