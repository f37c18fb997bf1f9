// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { screenshot } from './support/browser.mjs';
import { onScreen } from './support/drawn.mjs';
import { limit, sceneArguments, setStage } from './support/stage.mjs';

const serverArguments = ({ recording, ...scene }) => [
  ...sceneArguments(scene),
  ...['--replay', recording, '--tracked', join(recording, 'tracked')],
];
const stage = setStage({ serverArguments });

async function open() {
  const opened = await stage.open();
  await opened.page.setViewportSize({ width: 1280, height: 800 });
  await ready(opened.page);
  return opened;
}

const ready = (page) =>
  page.waitForFunction(() => window.__pcavr?.replay && window.__pcavr.scene.isComplete);
const replayModel = async () => (await fetch(`${stage.server.url}api/replay.json`)).json();
const forcePlot = (page) => page.locator('.plot', { hasText: 'Force' });
const ticks = (plot, axis = 'x') =>
  plot.locator(`g[data-mark="${axis}-axis tick label"] text`).allTextContents();

async function pointAt(page, plot, share) {
  const box = await plot.locator('.over').boundingBox();
  await page.mouse.move(box.x + share * box.width, box.y + box.height / 2, { steps: 3 });
}

test('a plot shows time and all values at the pointer, in every plot', limit, async () => {
  const { page, seen } = await open();
  await pointAt(page, forcePlot(page), 0.5);
  const lines = await forcePlot(page).locator('.readout div').allTextContents();
  const { duration } = await page.evaluate(() => ({ duration: window.__pcavr.timeline.duration }));
  assert.ok(Math.abs(parseFloat(lines[0]) - duration / 2) < 0.02 * duration, lines[0]);
  assert.match(lines[1], /^measured: (-?[\d.]+ N|–)$/);
  assert.match(lines[2], /^predicted: (-?[\d.]+ N|–)$/);
  assert.equal(lines.length, 3);
  assert.equal(await page.locator('.readout').count(), 2);
  for (const readout of await page.locator('.readout').all()) assert.ok(await readout.isVisible());
  await screenshot(page, 'plots-pointed');
  assert.deepEqual(seen.errors, []);
});

test('a drag zooms all plots, a double click shows all, a click goes there', limit, async () => {
  const { page } = await open();
  const plot = forcePlot(page);
  const other = page.locator('.plot', { hasText: 'Prediction error' });
  const whole = await ticks(plot);
  await pointAt(page, plot, 0.2);
  await page.mouse.down();
  await pointAt(page, plot, 0.4);
  await page.mouse.up();
  const zoomed = (await ticks(plot)).map(Number);
  const { duration } = await page.evaluate(() => ({ duration: window.__pcavr.timeline.duration }));
  assert.ok(Math.min(...zoomed) > 0.15 * duration && Math.max(...zoomed) < 0.45 * duration);
  assert.deepEqual((await ticks(other)).map(Number), zoomed);
  await pointAt(page, plot, 0.5);
  await page.mouse.click(...Object.values(await middle(plot)));
  const { time } = await page.evaluate(() => ({ time: window.__pcavr.timeline.time }));
  assert.ok(Math.abs(time - 0.3 * duration) < 0.02 * duration, `${time} of ${duration} s`);
  const { x, y } = await middle(plot);
  await page.mouse.dblclick(x, y);
  assert.deepEqual(await ticks(plot), whole);
});

async function middle(plot) {
  const { x, y, width, height } = await plot.locator('.over').boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
}

test('the time axes of all plots are as far from the edges', limit, async () => {
  const { page } = await open();
  const insets = await page.locator('.plot').evaluateAll((plots) =>
    plots.map((plot) => {
      const outer = plot.getBoundingClientRect();
      const inner = plot.querySelector('.over').getBoundingClientRect();
      return [inner.left - outer.left, outer.right - inner.right];
    }),
  );
  assert.equal(insets.length, 2);
  assert.deepEqual(insets[0], insets[1]);
});

test('a plot is saved as SVG and as CSV', limit, async () => {
  const { page } = await open();
  const plot = forcePlot(page);
  const save = async (name) => {
    const saved = page.waitForEvent('download');
    await plot.getByRole('button', { name }).click();
    const file = await saved;
    return { name: file.suggestedFilename(), text: readFileSync(await file.path(), 'utf8') };
  };
  const drawing = await save('SVG');
  const name = (await plot.locator('.title').textContent()).replace('Force on ', '');
  assert.equal(drawing.name, `Force-on-${name}.svg`);
  assert.match(drawing.text, /^<svg/);
  assert.ok(!drawing.text.includes('var(--'), 'no colour depends on the style sheet');
  const table = await save('CSV');
  assert.equal(table.name, `Force-on-${name}.csv`);
  const [head, ...rows] = table.text.trimEnd().split('\r\n');
  assert.equal(
    head,
    "time (s),time on the recording's clock (s),object,phase measured,phase predicted," +
      'measured (N),predicted (N),x as recorded (N),y as recorded (N),z as recorded (N)',
  );
  const model = await replayModel();
  assert.equal(rows.length, model.objects.find((object) => object.name === name).force.rows);
  const pushing = rows.map((row) => row.split(',')).find(([, , , phase]) => phase === 'sliding');
  assert.equal(pushing[2], name);
  assert.ok(Math.abs(pushing[1] - pushing[0] - model.start) < 1e-5, `${pushing}`);
  const components = pushing.slice(7).map(Number);
  assert.ok(Math.abs(Math.hypot(...components) - pushing[5]) < 1, `${pushing}`);
});

test('the edge of the plots makes them higher, also by keys, and is kept', limit, async () => {
  const { page, seen } = await open();
  const grip = page.getByRole('separator', { name: 'Height of the plots' });
  // At once: the drawing is replaced with each change.
  const height = () =>
    page.evaluate(() => document.querySelector('.plot svg').getBoundingClientRect().height);
  const [first, { x, y, width }] = [await height(), await grip.boundingBox()];
  assert.ok(first >= 190, `${first} pixels at first`);
  await page.mouse.move(x + width / 2, y + 4);
  await page.mouse.down();
  await page.mouse.move(x + width / 2, y - 96, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await height()) - first - 100) < 2, `${await height()} pixels`);
  await screenshot(page, 'plots-high');
  await grip.press('ArrowDown');
  assert.ok(Math.abs((await height()) - first - 80) < 2);
  const kept = await height();
  await page.reload();
  await ready(page);
  assert.equal(await height(), kept);
  await grip.dblclick();
  assert.equal(await height(), first);
  await grip.press('End');
  assert.ok((await page.locator('#stage').boundingBox()).height > 120, 'the scene is in sight');
  await grip.press('Home');
  await grip.dblclick();
  assert.deepEqual(seen.errors, []);
});

test('a spike is marked at the edge, and does not flatten the force', limit, async () => {
  const page = await stage.browser.context.newPage();
  await page.setViewportSize({ width: 1280, height: 800 });
  const { force } = (await replayModel()).objects[0];
  const bytes = Buffer.from(await (await fetch(`${stage.server.url}api/replay.bin`)).arrayBuffer());
  const measuredAt = (row) => force.at + 12 * row + 4;
  bytes.writeFloatLE(72, measuredAt(Math.floor(force.rows / 2)));
  await page.route('**/api/replay.bin', (route) => route.fulfill({ body: bytes }));
  await page.goto(stage.server.url);
  await ready(page);
  const plot = forcePlot(page);
  const spike = plot.locator('[data-mark="spike value"]');
  assert.deepEqual(await spike.allTextContents(), ['72 N']);
  const top = Math.max(...(await ticks(plot, 'y')).map(Number));
  assert.ok(top < 20, `the axis reaches to ${top} N`);
  await screenshot(page, 'plots-spike');
});

test('a tooltip stays with its cursor when a zoom changes the times', limit, async () => {
  const { page } = await open();
  const plot = forcePlot(page);
  const { duration } = await page.evaluate(() => ({ duration: window.__pcavr.timeline.duration }));
  const shown = async () => parseFloat(await plot.locator('.readout div').first().textContent());
  await pointAt(page, plot, 0.2);
  await page.mouse.down();
  await pointAt(page, plot, 0.4);
  await page.mouse.up();
  // At 0.4 of the axis, which is from 0.2 to 0.4 of the replay now.
  assert.ok(Math.abs((await shown()) - 0.28 * duration) < 0.01 * duration, `${await shown()} s`);
  const { x, width } = await plot.locator('.over').boundingBox();
  const line = await plot.locator('.pointed').boundingBox();
  assert.ok(Math.abs(line.x - x - 0.4 * width) < 2, 'the line is under the cursor');
  await plot.getByRole('button', { name: 'Show all' }).click();
  await pointAt(page, plot, 0.4);
  assert.ok(Math.abs((await shown()) - 0.4 * duration) < 0.01 * duration);
});

test('phases are below the curves, and components appear on demand', limit, async () => {
  const { page } = await open();
  const plot = forcePlot(page);
  const curve = await plot.locator('[data-mark="line"]').first().boundingBox();
  const lanes = await plot.locator('rect[data-mark="phase"]').all();
  assert.ok(lanes.length > 2, `${lanes.length} phases`);
  for (const lane of lanes) assert.ok((await lane.boundingBox()).y > curve.y + curve.height - 1);
  assert.deepEqual(await plot.locator('[data-mark="lane names"] text').allTextContents(), [
    'measured',
    'predicted',
  ]);
  const curves = () => plot.locator('[data-mark="line"]').count();
  assert.equal(await curves(), 2);
  await plot.getByRole('button', { name: 'x y z' }).click();
  assert.equal(await curves(), 5);
  await pointAt(page, plot, 0.5);
  assert.match(await plot.locator('.readout').textContent(), /x as recorded: /);
  await screenshot(page, 'plots-components');
  await plot.getByRole('button', { name: 'x y z' }).click();
  assert.equal(await curves(), 2);
});

test('the plots follow the touched object, unless one is chosen', limit, async () => {
  const { page } = await open();
  const { objects } = await replayModel();
  const title = () => forcePlot(page).locator('.title').textContent();
  for (const { name, phases } of objects) {
    const { t } = phases.find(({ measured }) => measured === 'sliding');
    await page.locator('#scrub').fill(String(Number((t + 0.02).toFixed(2))));
    assert.equal(await title(), `Force on ${name}`);
  }
  await page.selectOption('#plotted', objects[0].name);
  assert.equal(await title(), `Force on ${objects[0].name}`);
  await page.selectOption('#plotted', '');
  assert.equal(await title(), `Force on ${objects.at(-1).name}`);
});

test('measuring shows both ends, the distance and its components in the scene', limit, async () => {
  const { page } = await open();
  await page.click('#measure');
  const bodies = await page.evaluate(() => window.__pcavr.bodies.map(({ position }) => position));
  for (const position of bodies) {
    const { x, y } = await onScreen(page, position);
    await page.mouse.click(x, y);
  }
  const labels = page.locator('.measure:visible');
  await labels.nth(2).waitFor();
  const [a, b, between] = await labels.allTextContents();
  const numbers = (text) => text.match(/−?-?\d+\.\d/g).map(Number);
  assert.match(a, /^A \(/);
  assert.match(b, /^B \(/);
  const [distance, ...components] = numbers(between);
  numbers(b).forEach((value, i) =>
    assert.ok(Math.abs(value - numbers(a)[i] - components[i]) < 0.11, between),
  );
  assert.ok(Math.abs(distance - Math.hypot(...components)) < 0.2, between);
  assert.equal(await page.locator('#distance').textContent(), between);
  await screenshot(page, 'plots-measured');
});

test('the picture is moved by its caption, enlarged and closed', limit, async () => {
  const page = await stage.browser.context.newPage();
  await page.setViewportSize({ width: 1280, height: 800 });
  const model = await (await fetch(`${stage.server.url}api/replay.json`)).json();
  const replay = { ...model, frames: { t: [0], width: 4, height: 3 } };
  await page.route('**/api/replay.json', (route) => route.fulfill({ json: replay }));
  const body = '<svg xmlns="http://www.w3.org/2000/svg" width="400" height="300"/>';
  await page.route('**/api/frames/0.jpg', (route) =>
    route.fulfill({ contentType: 'image/svg+xml', body }),
  );
  await page.goto(stage.server.url);
  await page.waitForFunction(() => window.__pcavr?.replay);
  await page.click('#picture-toggle');
  const figure = page.locator('#picture');
  await figure.locator('.caption', { hasText: 'Recorded' }).waitFor();
  const before = await figure.boundingBox();
  const caption = await figure.locator('.caption').boundingBox();
  await page.mouse.move(caption.x + 20, caption.y + 5);
  await page.mouse.down();
  await page.mouse.move(caption.x - 180, caption.y - 95, { steps: 4 });
  await page.mouse.up();
  const after = await figure.boundingBox();
  assert.ok(Math.abs(after.x - before.x + 200) < 2 && Math.abs(after.y - before.y + 100) < 2);
  await page.click('#picture-enlarge');
  const large = await figure.boundingBox();
  const whole = await page.locator('#stage').boundingBox();
  assert.ok(Math.abs(large.width - whole.width) < 2 && Math.abs(large.height - whole.height) < 2);
  await page.click('#picture-enlarge');
  assert.ok(Math.abs((await figure.boundingBox()).width - before.width) < 2);
  await page.click('#picture-close');
  assert.equal(await figure.isVisible(), false);
  assert.equal(await page.locator('#picture-toggle').getAttribute('aria-pressed'), 'false');
});
