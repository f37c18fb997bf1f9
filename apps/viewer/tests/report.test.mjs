// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser, openPage, screenshot } from './support/browser.mjs';
import { makeScene } from './support/pcavr.mjs';
import { sample, writeReport } from './support/report_sample.mjs';
import { limit } from './support/stage.mjs';

const maxPrintedPages = 6;

let browser;
let report;

before(async () => {
  browser = await openBrowser();
  report = writeReport(sample);
}, limit);
after(async () => {
  await browser.close();
  report.remove();
});

/// Opens a report, and expects that it loads nothing but itself and has no errors.
async function open(url) {
  const { page, seen } = await openPage(browser.context, url);
  await page.setViewportSize({ width: 1240, height: 900 });
  await page.locator('footer').waitFor();
  const requests = seen.requests.filter((request) => !request.startsWith('data:'));
  assert.deepEqual(requests, [url]);
  assert.deepEqual(seen.errors, []);
  return { page, seen };
}

test('a report shows its headings, tables and plots without a network', limit, async () => {
  const { page, seen } = await open(report.url);
  assert.equal(await page.title(), sample.title);
  assert.deepEqual(await page.locator('h1, h2').allTextContents(), [
    'Run evaluation',
    'Overview',
    'box_1',
  ]);
  // Names are text, not markup.
  assert.equal(await page.locator('.input b').first().textContent(), '<b>my & run</b>');
  assert.deepEqual(await page.locator('.note').allTextContents(), [
    'box_3 has no pose in this run.',
    'The tool jumps.',
  ]);
  const verdict = sample.verdict.replace('0.17 mm', '0.17\u00a0mm'); // on one line
  assert.equal(await page.locator('.verdict').textContent(), verdict);
  assert.equal(await page.locator('.headline tbody tr').count(), 5);
  const all = page.locator('details', { hasText: 'All main figures (16)' });
  assert.equal(await all.locator('tbody tr').count(), 16);
  assert.equal(await all.locator('tbody tr').first().isVisible(), false);
  await all.locator('summary').click();
  const gap = await all.evaluate((details) => {
    const bottom = details.querySelector('table').getBoundingClientRect().bottom;
    return details.nextElementSibling.getBoundingClientRect().top - bottom;
  });
  assert.ok(gap >= 16, `${gap} px below the table`);
  await all.locator('summary').click();
  assert.equal(await page.locator('figure.map svg').count(), 2); // with its error strip
  assert.equal(await page.locator('td', { hasText: 'missed' }).getAttribute('class'), 'number');
  assert.equal(await page.locator('figure .drawing svg').count(), 4);
  assert.equal(await page.locator('figure.map').count(), 1);
  const legend = await page.locator('figure', { hasText: 'force of the tool' }).locator('.legend');
  assert.deepEqual(await legend.locator('span').allTextContents(), [
    'measured',
    'rendered (virtual)',
    'static',
    'critical',
    'sliding',
    '▼correction arrives',
    '▽correction lost',
  ]);
  // Lines have been drawn, and no coordinate is invalid.
  const paths = await page
    .locator('.drawing g[data-mark=line] path')
    .evaluateAll((all) => all.map((path) => path.getAttribute('d')));
  assert.equal(paths.length, 4);
  for (const path of paths) assert.match(path, /^M[-\d.]+,[-\d.]+L/);
  assert.equal((await page.locator('main').innerHTML()).includes('NaN'), false);
  await screenshot(page, 'report');
  assert.match(
    await page.locator('footer .origin').textContent(),
    /^Made by pcavr evaluate 'my & run'; file of \d{4}-\d\d-\d\d \d\d:\d\d UTC$/,
  );
  assert.deepEqual(seen.errors, []);
});

test(
  'a report is dark where that is wished, and keeps its colours in forced ones',
  limit,
  async () => {
    const { page, seen } = await open(report.url);
    const style = (selector, property) =>
      page
        .locator(selector)
        .first()
        .evaluate((e, name) => getComputedStyle(e)[name], property);
    assert.equal(await style('body', 'backgroundColor'), 'rgb(255, 255, 255)');
    await page.emulateMedia({ colorScheme: 'dark' });
    assert.equal(await style('body', 'backgroundColor'), 'rgb(21, 25, 30)');
    await screenshot(page, 'report-dark');
    await page.emulateMedia({ colorScheme: 'light', forcedColors: 'active' });
    const key = '.legend .area';
    assert.notEqual(await style(key, 'backgroundColor'), await style('body', 'backgroundColor'));
    // Without colours, too, "critical" differs from "static".
    assert.match(await style(`${key}.critical`, 'backgroundImage'), /^repeating-linear-gradient/);
    assert.ok(
      (await page
        .locator('.drawing rect[fill^="url(#hatch"], .drawing g[fill^="url(#hatch"]')
        .count()) > 0,
    );
    assert.deepEqual(seen.errors, []);
  },
);

test('a plot shows values at the pointer, zooms in, and shows all again', limit, async () => {
  const { page, seen } = await open(report.url);
  const figure = page.locator('figure', { hasText: 'force of the tool' });
  const drawing = figure.locator('.drawing');
  await drawing.scrollIntoViewIfNeeded();
  const box = await drawing.boundingBox();
  const ticks = () => figure.locator('g[data-mark="x-axis tick label"] text').allTextContents();
  const whole = await ticks();
  await page.mouse.move(box.x + 200, box.y + 100);
  const tip = figure.locator('g[aria-label=tip]', { hasText: 'force (N):' });
  await tip.waitFor();
  const values = await tip.textContent();
  assert.match(values, /time \(s\): [\d.]+/);
  for (const name of ['measured', 'rendered \\(virtual\\)'])
    assert.match(values, new RegExp(`${name} (−|-)?[\\d.]+`));
  await page.mouse.move(box.x + 100, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 110, { steps: 3 });
  await page.mouse.up();
  const zoomed = await ticks();
  assert.notDeepEqual(zoomed, whole);
  assert.ok(Math.max(...zoomed.map(Number)) < Math.max(...whole.map(Number)) / 2, `${zoomed}`);
  await screenshot(page, 'report-zoomed');
  await figure.getByRole('button', { name: 'Show all' }).click();
  assert.deepEqual(await ticks(), whole);
  assert.deepEqual(seen.errors, []);
});

test('a plot can be saved as a drawing', limit, async () => {
  const { page } = await open(report.url);
  const saved = page.waitForEvent('download');
  await page.locator('figure.map').getByRole('button', { name: 'Save SVG' }).click();
  assert.equal((await saved).suggestedFilename(), 'box_1-predicted-path-from-above.svg');
});

test('a plot is saved as a table with all its numbers', limit, async () => {
  const { page } = await open(report.url);
  const saveOf = async (figure) => {
    const saved = page.waitForEvent('download');
    await figure.getByRole('button', { name: 'Save CSV' }).click();
    const file = await saved;
    return readFileSync(await file.path(), 'utf8')
      .trimEnd()
      .split('\r\n');
  };
  const map = await saveOf(page.locator('figure.map'));
  assert.match(map[0], /^reference: x in base \(m\),reference: y in base \(m\),measured: x/);
  assert.equal(map.length, 4001);
  assert.match(map[1], /,0,0\.1$/);
  assert.match(map[4], /,,$/);
  const lanes = await saveOf(page.locator('figure.wide'));
  assert.equal(lanes[0], 'group,lane,from,to,kind');
  assert.equal(lanes[1], 'box_1,truth,0,2,free');
});

test('a printed report has all sections, and neither buttons nor long tables', limit, async () => {
  const { page } = await open(report.url);
  await page.evaluate(() =>
    document.querySelectorAll('.section').forEach((one) => (one.open = false)),
  );
  await page.emulateMedia({ media: 'print' });
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  assert.equal(await page.locator('details.section:not([open])').count(), 0);
  assert.equal(await page.getByRole('button').first().isVisible(), false);
  assert.equal(
    await page.locator('details', { hasText: 'Each correction' }).last().isVisible(),
    false,
  );
});

test('the text of printed plots can be read', limit, async () => {
  const { page } = await open(report.url);
  await page.setViewportSize({ width: 718, height: 1000 }); // A4 without its margins
  await page.emulateMedia({ media: 'print' });
  const sizes = () =>
    page
      .locator('.drawing svg')
      .evaluateAll((all) =>
        all.map((svg) => (12 * svg.getBoundingClientRect().width) / svg.viewBox.baseVal.width),
      );
  const minSize = 8.6; // [px]: 6.5 points
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  const printed = await sizes();
  assert.equal(printed.length, 4);
  for (const size of printed) assert.ok(size > minSize, `${printed}`);
  await screenshot(page, 'report-printed');
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  assert.ok(Math.min(...(await sizes())) < minSize, 'drawn for the screen again');
});

test('the reports of the command open', { timeout: 180_000 }, async (t) => {
  const made = makeScene();
  const path = (name) => join(made.folder, name);
  const run = (...args) => execFileSync(process.env.PCAVR_COMMAND, args, { stdio: 'pipe' });
  try {
    const goal = ['identify', 'friction', made.recording, '--scene', made.scene];
    run(...goal, '-o', path('found.yaml'), '--report', path('found'));
    if (!existsSync(path('found/report.html'))) {
      t.skip('the command was built before the page');
      return;
    }
    // The recording has no images to track: the true poses.
    for (const name of ['box_1', 'box_2']) {
      mkdirSync(path(`tracked/objects/${name}`), { recursive: true });
      const pose = path(`recording/truth/objects/${name}.txt`);
      copyFileSync(pose, path(`tracked/objects/${name}/tracked.txt`));
    }
    const inputs = ['--scene', made.scene, '--tracked', path('tracked')];
    run('replay', made.recording, ...inputs, '-o', path('run'));
    run('evaluate', path('run'), '--truth', path('recording/truth'), '-o', path('evaluated'));
    for (const name of ['found', 'evaluated']) {
      const { page } = await open(`file://${path(name)}/report.html`);
      assert.ok((await page.locator('figure svg').count()) > 0, name);
      assert.ok((await page.locator('tbody tr').count()) > 0, name);
      await screenshot(page, `report-${name}`);
      const pdf = (await page.pdf({ format: 'A4' })).toString('latin1');
      const pages = Number(/\/Count (\d+)/.exec(pdf)?.[1]);
      assert.ok(pages >= 1 && pages <= maxPrintedPages, `${name}: ${pages} pages`);
    }
  } finally {
    made.remove();
  }
});

test('a table is saved as it is shown', limit, async () => {
  const { page } = await open(report.url);
  const nodes = page.locator('.tables > div', { hasText: 'Time nodes' });
  const saved = page.waitForEvent('download');
  await nodes.getByRole('button', { name: 'Save CSV' }).click();
  const text = readFileSync(await (await saved).path(), 'utf8');
  assert.equal(text.split('\r\n')[1], 't1,box_1,contact,2.000,-');
});

test('long headings of numbers wrap before a table is cut', limit, async () => {
  const names = [
    'until the first peak is predicted within 10 % (ms)',
    'mean force error, tip at rest (%)',
  ];
  const headline = {
    ...sample.headline,
    columns: ['method', ...names, ...names],
    rows: [['BSLS', '104', '9.90', '106', '5.72']],
  };
  const wide = writeReport({ ...sample, headline });
  const { page } = await open(wide.url);
  await page.setViewportSize({ width: 1000, height: 900 });
  const box = page.locator('.headline .scroll');
  const [own, shown] = await box.evaluate((e) => [e.scrollWidth, e.clientWidth]);
  assert.ok(own <= shown, `${own} px in ${shown}`);
  wide.remove();
});

test('the contents lead to the sections', limit, async () => {
  const long = {
    ...sample,
    sections: ['a', 'b', 'c', 'd'].map((title) => ({ title, blocks: [] })),
  };
  const written = writeReport(long);
  const { page } = await open(written.url);
  const isOpen = () => page.locator('#section-4').evaluate((section) => section.open);
  assert.equal(await isOpen(), false);
  await page.locator('.contents').getByRole('link', { name: 'd' }).click();
  assert.equal(await isOpen(), true);
  written.remove();
});
