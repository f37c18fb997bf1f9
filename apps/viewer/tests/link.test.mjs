// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Two programs and a page: a live simulated plant is pushed through 200 + 200 ms.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded, onScreen } from './support/drawn.mjs';
import { until } from './support/live.mjs';
import { makeScene } from './support/pcavr.mjs';
import { startOperator, startRobot } from './support/sites.mjs';

const limit = { timeout: 120_000 };
const delay = ['--forward-delay', '0.2', '--backward-delay', '0.2'];

let scene;
let browser;
let robot;
let site;

before(async () => {
  scene = makeScene();
  browser = await openBrowser();
  robot = await startRobot(scene.scene);
  const port = robot.ready.port;
  site = await startOperator(scene.scene, port, '--parameters', scene.parameters, ...delay);
}, limit);
afterEach(() => browser?.closePages());
after(async () => {
  await browser?.close();
  await site?.stop();
  await robot?.stop();
  scene?.remove();
});

const stateOf = (page) => page.evaluate(() => window.__pcavr.state);

async function openSite() {
  const opened = await openPage(browser.context, site.ready.addresses[0]);
  await loaded(opened.page);
  await opened.page.waitForFunction(() => window.__pcavr.state?.link?.isConnected);
  return opened;
}

async function drag(page, points) {
  const box = await page.locator('#handle').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  for (const point of points) {
    const { x, y } = await onScreen(page, point);
    await page.mouse.move(x, y, { steps: 40 });
    await page.waitForTimeout(300);
  }
}

test('a box of the live plant is pushed, and shown where the robot sees it', limit, async () => {
  const { page, seen } = await openSite();
  const first = await stateOf(page);
  assert.ok(first.link.lead > 0.2 && first.link.lead < 0.5, `lead ${first.link.lead}`);
  const [x, y, z] = first.objects[0].position;
  const start = first.link.robot.objects[0].position;
  // Beside the box, down with Shift to its height, then against it.
  await drag(page, [[x - 0.22, y, first.proxy[2]]]);
  await page.keyboard.down('Shift');
  const low = await onScreen(page, [x - 0.22, y, z]);
  await page.mouse.move(low.x, low.y, { steps: 40 });
  await page.keyboard.up('Shift');
  await until(async () => Math.abs((await stateOf(page)).proxy[2] - z) < 0.03, 'the height');
  const goal = await onScreen(page, [x + 0.02, y, z]);
  await page.mouse.move(goal.x, goal.y, { steps: 80 });
  await until(async () => {
    const { link, force } = await stateOf(page);
    return Math.hypot(...force) > 0.5 && link.robot.objects[0].position[0] > start[0] + 0.02;
  }, "the robot's box pushed, and a force on the hand");
  await screenshot(page, 'link-pushing');
  await page.mouse.up();
  await page.waitForTimeout(1500); // a round trip, and the last corrections
  const { objects, link } = await stateOf(page);
  const apart = Math.hypot(
    ...objects[0].position.map((v, i) => v - link.robot.objects[0].position[i]),
  );
  assert.ok(apart < 0.003, `shown and tracked differ by ${1000 * apart} mm`);
  assert.deepEqual(seen.errors, []);
});

test('silence is shown within 0.5 s, the clutch opens, and the link resumes', limit, async () => {
  const { page } = await openSite();
  robot.signal('SIGSTOP');
  const silent = performance.now();
  await page.waitForFunction(() => !document.getElementById('link-alert').hidden);
  const seconds = (performance.now() - silent) / 1000;
  await screenshot(page, 'link-silent');
  // Messages that were on their way arrive for another 0.2 s of the simulated network.
  assert.ok(seconds < 0.5 + 0.2, `shown after ${seconds} s`);
  assert.equal((await stateOf(page)).isEngaged, false);
  await page.waitForTimeout(1000);
  robot.signal('SIGCONT');
  await page.waitForFunction(() => window.__pcavr.state?.link?.isConnected);
  await page.waitForFunction(() => document.getElementById('link-alert').hidden);
});

test('an emergency stop reaches the robot, and only its release ends it', limit, async () => {
  const { page } = await openSite();
  await page.keyboard.press('x');
  await page.waitForFunction(() => window.__pcavr.state?.link?.robot?.isStopped);
  await screenshot(page, 'link-stopped');
  const stopped = await stateOf(page);
  assert.ok(stopped.isStopped);
  await page.keyboard.press('x');
  await page.locator('#view').focus();
  await page.keyboard.press('h'); // resumes a hold, not a stop
  await page.waitForTimeout(800);
  assert.ok((await stateOf(page)).link.robot.isStopped);
  await page.click('#release-stop');
  await page.waitForFunction(() => window.__pcavr.state?.link?.robot?.isStopped === false);
  await page.waitForFunction(() => !window.__pcavr.state.isStopped);
  assert.ok((await stateOf(page)).isOnHold, 'on hold after the release');
});
