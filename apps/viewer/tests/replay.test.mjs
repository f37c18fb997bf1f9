// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { openPage, screenshot } from './support/browser.mjs';
import { drawnBodies } from './support/drawn.mjs';
import { distance } from './support/live.mjs';
import { run } from './support/pcavr.mjs';
import { limit, sceneArguments, setStage } from './support/stage.mjs';

const poseBytes = 32; // of a row t, position, quaternion
const rounding = 1e-6; // [m] of numbers in single precision near 1

let model, binary;
const serverArguments = ({ recording, ...scene }) => [
  ...sceneArguments(scene),
  ...['--replay', recording, '--tracked', join(recording, 'tracked')],
];
const stage = setStage({ serverArguments }, async ({ server: { url } }) => {
  model = await (await fetch(`${url}api/replay.json`)).json();
  binary = new DataView(await (await fetch(`${url}api/replay.bin`)).arrayBuffer());
});

/// Time and position of a row of poses.
function row({ at }, index) {
  const value = (i) => binary.getFloat32(at + index * poseBytes + 4 * i, true);
  return { t: value(0), position: [value(1), value(2), value(3)] };
}

/// The position at a time, linearly interpolated between two rows.
function positionAt(table, time) {
  let i = 0;
  while (i + 2 < table.rows && row(table, i + 1).t <= time) ++i;
  const [a, b] = [row(table, i), row(table, i + 1)];
  const fraction = (time - a.t) / (b.t - a.t);
  return a.position.map((value, k) => value + fraction * (b.position[k] - value));
}

/// A time at which an object has been pushed.
function timeOfPush({ predicted }) {
  const first = row(predicted, 0).position;
  for (let i = 0; i < predicted.rows; ++i) {
    const { t, position } = row(predicted, i);
    if (distance(position, first) > 0.01) return t;
  }
  throw new Error('nothing is pushed in this replay');
}

async function open() {
  const opened = await stage.open();
  await opened.page.waitForFunction(
    () => window.__pcavr?.replay && window.__pcavr.scene.isComplete,
  );
  return opened;
}

const timeline = (page) =>
  page.evaluate(() => {
    const { time, isPlaying, duration } = window.__pcavr.timeline;
    return { time, isPlaying, duration };
  });

test('a replay plays, and stops while paused', limit, async () => {
  const { page, seen } = await open();
  assert.ok(Math.abs((await timeline(page)).duration - model.duration) < rounding);
  await page.click('#play');
  await page.waitForFunction(() => window.__pcavr.timeline.time > 0.3);
  await page.click('#play');
  const { time, isPlaying } = await timeline(page);
  assert.equal(isPlaying, false);
  await page.waitForTimeout(200);
  assert.equal((await timeline(page)).time, time);
  assert.deepEqual(seen.errors, []);
});

test('after a seek, bodies and ghosts are at their recorded poses', limit, async () => {
  const { page, seen } = await open();
  for (const wanted of [...model.objects.map(timeOfPush), 0.5 * model.duration, 1]) {
    await page.locator('#scrub').fill(String(Number(wanted.toFixed(2))));
    const { time } = await timeline(page);
    assert.ok(Math.abs(time - wanted) <= 0.01, `${time} is not ${wanted}`);
    const bodies = await drawnBodies(page);
    for (const { name, predicted, tracked } of model.objects) {
      const body = bodies.find((b) => b.name === name);
      assert.ok(distance(body.position, positionAt(predicted, time)) < rounding, name);
      assert.ok(distance(body.ghost, positionAt(tracked, time)) < rounding, `${name}'s ghost`);
    }
    if (wanted === timeOfPush(model.objects[0])) await screenshot(page, 'replay');
  }
  assert.deepEqual(seen.errors, []);
});

test('the arrow shows the reaction force on the recorded tool', limit, async () => {
  const { page } = await open();
  const { at, rows } = model.tool;
  const value = (index, i) => binary.getFloat32(at + 28 * index + 4 * i, true);
  const time = timeOfPush(model.objects[0]);
  let index = 0;
  while (index + 1 < rows && value(index + 1, 0) <= time) ++index;
  await page.locator('#scrub').fill(String(Number(time.toFixed(2))));
  const force = await page.evaluate(() => window.__pcavr.app.view.tool.force);
  // The recording has the force that the tool exerts, here 4 N and more; the reaction is opposite.
  // The magnitude is not compared: sensor noise differs from row to row.
  const exerted = [4, 5, 6].map((i) => value(index, i));
  assert.ok(Math.hypot(...exerted) > 2);
  assert.ok(exerted.reduce((sum, value, i) => sum + value * force[i], 0) < 0, `${force}`);
});

test(
  'a missing image is reported by its recording time, and the next one is shown',
  limit,
  async () => {
    const page = await stage.browser.context.newPage();
    const frames = { t: [0, 1, 2], width: 1, height: 1 };
    const replay = { ...model, frames };
    await page.route('**/api/replay.json', (route) => route.fulfill({ json: replay }));
    const waiting = new Promise((resolve) => page.route('**/api/frames/0.jpg', resolve));
    await page.route('**/api/frames/2.jpg', (route) =>
      route.fulfill({
        contentType: 'image/svg+xml',
        body: '<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>',
      }),
    );
    await page.goto(stage.server.url);
    await page.waitForFunction(() => window.__pcavr?.replay);
    await page.click('#picture-toggle');
    const first = await waiting;
    await page.locator('#scrub').fill('2');
    await first.fulfill({ status: 404 });
    await page.locator('#picture figcaption', { hasText: 'Recorded at 2.00 s' }).waitFor();
  },
);

test('at speed 2 the replay advances twice as fast', limit, async () => {
  const { page } = await open();
  await page.selectOption('#speed', '2');
  const ratio = await page.evaluate(
    () =>
      new Promise((resolve) => {
        const { timeline, app } = window.__pcavr;
        let first;
        document.querySelector('#play').click();
        // Measured by the frame timestamps, so that the frame rate does not matter.
        app.onFrame((now) => {
          first ??= { now, time: timeline.time };
          const seconds = (now - first.now) / 1000;
          if (seconds > 0.5) resolve((timeline.time - first.time) / seconds);
        });
      }),
  );
  assert.ok(Math.abs(ratio - 2) < 0.1, `${ratio} times`);
});

test(
  'the time line marks events, and buttons and keys go from one to the next',
  limit,
  async () => {
    const { page, seen } = await open();
    await page.setViewportSize({ width: 1280, height: 800 });
    const contacts = model.objects
      .flatMap(({ name, phases }) =>
        phases
          .filter(
            ({ measured }, i) =>
              measured !== 'free' && (phases[i - 1]?.measured ?? 'free') === 'free',
          )
          .map(({ t }) => ({ t, name })),
      )
      .sort((a, b) => a.t - b.t);
    assert.ok(contacts.length >= 2, `${contacts.length} contacts`);
    const marks = page.locator('#event-marks path[data-mark=contact]');
    assert.equal((await marks.getAttribute('d')).match(/M/g).length, contacts.length);
    await page.selectOption('#event-kind', 'contact');
    for (const { t, name } of contacts) {
      await page.getByRole('button', { name: 'Next event' }).click();
      assert.ok(Math.abs((await timeline(page)).time - t) < rounding);
      assert.equal(await page.locator('#event').textContent(), `contact with ${name}`);
      await page.locator('.plot .title', { hasText: `Force on ${name}` }).waitFor();
    }
    await page.getByRole('button', { name: 'Next event' }).click();
    assert.equal(await page.locator('#event').textContent(), 'no later event');
    await screenshot(page, 'replay-events');
    await page.focus('#view');
    await page.keyboard.press('p');
    assert.ok(Math.abs((await timeline(page)).time - contacts.at(-2).t) < rounding);
    await page.keyboard.press('n');
    assert.ok(Math.abs((await timeline(page)).time - contacts.at(-1).t) < rounding);
    await page.selectOption('#event-kind', 'breakaway');
    await page.getByRole('button', { name: 'Previous event' }).click();
    assert.match(await page.locator('#event').textContent(), /^breakaway of /);
    await page.keyboard.press('?');
    await page.locator('#shortcuts', { hasText: 'to the next event' }).waitFor();
    await screenshot(page, 'replay-keys');
    assert.deepEqual(seen.errors, []);
  },
);

test('the view follows the tool', limit, async () => {
  const { page } = await open();
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.getByRole('button', { name: 'Follow tool' }).click();
  for (const { t } of model.objects.map((object) => ({ t: timeOfPush(object) }))) {
    await page.locator('#scrub').fill(String(Number(t.toFixed(2))));
    await page.waitForFunction(() => {
      const { app } = window.__pcavr;
      const tool = app.view.tool.proxy.getWorldPosition(app.camera.position.clone());
      tool.project(app.camera);
      return Math.hypot(tool.x, tool.y) < 0.02; // in the middle of the picture
    });
  }
  await screenshot(page, 'replay-followed');
});

test('a link restores view, layers and time', limit, async () => {
  const { page, seen } = await open();
  await page.locator('#scrub').fill('1.5');
  await page.evaluate(() => window.__pcavr.app.view.layers.show('frames', true));
  await page.focus('#view');
  await page.keyboard.down('KeyJ');
  await page.waitForTimeout(300);
  await page.keyboard.up('KeyJ');
  const look = () =>
    page.evaluate(() => {
      const { view } = window.__pcavr.app;
      return [...view.camera.position.toArray(), ...view.camera.quaternion.toArray()];
    });
  await page.waitForFunction(() => /view=.*&layers=.*&t=1\.5/.test(location.hash));
  // The address follows the view at most every half second.
  let [before, url] = [[], ''];
  while (url !== page.url()) {
    [before, url] = [await look(), page.url()];
    await page.waitForTimeout(1200);
  }
  await page.goto('about:blank');
  await page.goto(url);
  await page.waitForFunction(
    () => window.__pcavr?.replay && window.__pcavr.scene.isComplete && window.__pcavr.layers.frames,
  );
  await page.waitForFunction(() => Math.abs(window.__pcavr.timeline.time - 1.5) < 1e-9);
  const after = await look();
  before.forEach((value, i) =>
    assert.ok(Math.abs(value - after[i]) < 0.003, `${value} ${after[i]}`),
  );
  assert.deepEqual(seen.errors, []);
});

test(
  'a replay in one file opens without a server, and its view is saved as a video',
  limit,
  async () => {
    const { folder, recording, scene, parameters } = stage.scene;
    const file = join(folder, 'replay.html');
    run(
      ...['replay', recording, '--scene', scene, '--parameters', parameters],
      ...['--tracked', join(recording, 'tracked'), '--html', file, '-o', join(folder, 'run')],
    );
    assert.ok(statSync(file).size < 8e6, `${statSync(file).size} bytes`);
    const url = pathToFileURL(file).href;
    const { page, seen } = await openPage(stage.browser.context, url);
    await page.setViewportSize({ width: 1280, height: 800 });
    await page.waitForFunction(() => window.__pcavr?.replay && window.__pcavr.scene.isComplete);
    const wanted = timeOfPush(model.objects[0]);
    await page.locator('#scrub').fill(String(Number(wanted.toFixed(2))));
    const { time } = await timeline(page);
    const body = (await drawnBodies(page)).find(({ name }) => name === model.objects[0].name);
    assert.ok(distance(body.position, positionAt(model.objects[0].predicted, time)) < rounding);
    assert.equal(await page.locator('#connection').isVisible(), false);
    assert.equal(await page.getByRole('checkbox', { name: 'Robot' }).isChecked(), true);
    await screenshot(page, 'replay-file');
    const saved = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Record video' }).click();
    await page.click('#play');
    await page.waitForFunction((from) => window.__pcavr.timeline.time > from + 0.5, time);
    await page.getByRole('button', { name: 'Stop and save' }).click();
    const video = readFileSync(await (await saved).path());
    const isMp4 = video.toString('latin1', 4, 8) === 'ftyp';
    const isWebm = video.readUInt32BE(0) === 0x1a45dfa3;
    assert.ok((isMp4 || isWebm) && video.length > 5000, `${video.length} bytes`);
    const requests = seen.requests.filter((request) => !/^(data|blob):/.test(request));
    assert.deepEqual(requests, [url]);
    assert.deepEqual(seen.errors, []);

    // As after a download that broke off.
    const cut = join(folder, 'cut.html');
    const bytes = readFileSync(file);
    writeFileSync(cut, bytes.subarray(0, bytes.indexOf('id="carried-files"') + 1000));
    const opened = await openPage(stage.browser.context, pathToFileURL(cut).href);
    await opened.page.locator('#toasts', { hasText: 'This file is cut' }).waitFor();
    assert.deepEqual(opened.seen.errors, []);
  },
);
