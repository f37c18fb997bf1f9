// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Makes the pictures of the README and of docs/start.md from what ./demo has written:
//   PCAVR_COMMAND=build/test/apps/pcavr/pcavr node apps/viewer/scripts/pictures.mjs
import { copyFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { openBrowser, openPage } from '../tests/support/browser.mjs';
import { loaded } from '../tests/support/drawn.mjs';
import { serve } from '../tests/support/pcavr.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
const demo = join(root, 'out/demo');
const docs = (name) => join(root, 'docs', name);
const pushed = 8.8; // [s] of the replay: the first box slides
const reportWidth = 1180; // [px]: two plots side by side

process.env.PCAVR_PAGE ??= join(root, 'apps/viewer/dist');
copyFileSync(join(demo, 'scene/preview.png'), docs('preview.png'));

const parameters = ['--parameters', join(demo, 'parameters.yaml')];
const replay = ['--replay', join(demo, 'recording'), '--tracked', join(demo, 'run')];
const server = await serve(join(demo, 'scene'), ...parameters, ...replay);
const browser = await openBrowser();
try {
  const { page } = await openPage(browser.context, server.url);
  await page.setViewportSize({ width: 1280, height: 800 });
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.replay);
  await page.evaluate((time) => window.__pcavr.replay.seek(time), pushed);
  await page.waitForTimeout(1000); // the finer levels and the plots are drawn
  await page.screenshot({ path: docs('page.png') });

  const { page: report } = await openPage(
    browser.context,
    pathToFileURL(join(demo, 'report/report.html')).href,
  );
  await report.setViewportSize({ width: reportWidth, height: 900 });
  const plots = ['displacement from its start', 'force of the tool along the push'].map((title) =>
    report.locator('figure', { hasText: title }).first(),
  );
  await plots[0].scrollIntoViewIfNeeded();
  const boxes = await Promise.all(plots.map((plot) => plot.boundingBox()));
  const x = Math.min(...boxes.map((box) => box.x));
  const y = Math.min(...boxes.map((box) => box.y));
  const clip = {
    x,
    y,
    width: Math.max(...boxes.map((box) => box.x + box.width)) - x,
    height: Math.max(...boxes.map((box) => box.y + box.height)) - y,
  };
  await report.screenshot({ path: docs('push.png'), clip });
} finally {
  await browser.close();
  await server.stop();
}
