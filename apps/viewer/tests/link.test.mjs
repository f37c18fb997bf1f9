// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Two programs and a page: a live simulated plant is pushed through 200 + 200 ms.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { openBrowser, openPage, screenshot } from './support/browser.mjs';
import { loaded, onScreen } from './support/drawn.mjs';
import { distance, until } from './support/live.mjs';
import { makeScene } from './support/pcavr.mjs';
import { startOperator, startRobot } from './support/sites.mjs';

const limit = { timeout: 120_000 };
const delay = ['--forward-delay', '0.2', '--backward-delay', '0.2'];

/// A busy machine delays the sites and the page by more than a silent network: only the test of
/// silence keeps the defaults.
const timeouts = [
  'robot_site.link: {timeout: 5}',
  'operator_site: {timeout: 5}',
  'devices.page: {timeout: 10}',
].join('\n');

let scene;
let config;
let browser;
let sites = [];

before(async () => {
  scene = makeScene();
  config = join(scene.folder, 'timeouts.yaml');
  writeFileSync(config, timeouts);
  browser = await openBrowser();
}, limit);
afterEach(async () => {
  await browser?.closePages();
  for (const site of sites.reverse()) await site.stop();
  sites = [];
});
after(async () => {
  await browser?.close();
  scene?.remove();
});

/// Both sites, and the operator's page once it is connected.
async function openSites(...options) {
  const robot = await startRobot(scene.scene, 0, ...options);
  sites.push(robot);
  const site = await startOperator(
    scene.scene,
    robot.ready.port,
    '--parameters',
    scene.parameters,
    ...delay,
    ...options,
  );
  sites.push(site);
  const { page, seen } = await openPage(browser.context, site.ready.addresses[0]);
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state?.link?.isConnected);
  return { robot, page, seen };
}

const stateOf = (page) => page.evaluate(() => window.__pcavr.state);

/// Moves the mouse so that it shows points of base, from one to the other in `seconds`, or longer
/// where a busy machine is late: by at most `maxStep` [m] at once.
async function move(page, from, to, seconds, maxStep = 0.05) {
  const maxShare = maxStep / Math.hypot(...to.map((value, i) => value - from[i]));
  const begin = performance.now();
  for (let share = 0; share < 1;) {
    share = Math.min(1, share + maxShare, (performance.now() - begin) / (1000 * seconds));
    const point = from.map((value, i) => value + share * (to[i] - value));
    const { x, y } = await onScreen(page, point);
    await page.mouse.move(x, y);
    await page.waitForTimeout(20);
  }
}

/// The maximum of the force [N] on the hand over all frames from now on: between two requests of a
/// busy machine a push may begin and end.
async function watchForce(page) {
  await page.evaluate(() => {
    window.maxForce = 0;
    const look = () => {
      window.maxForce = Math.max(
        window.maxForce,
        Math.hypot(...(window.__pcavr.state?.force ?? [])),
      );
      requestAnimationFrame(look);
    };
    look();
  });
  return () => page.evaluate(() => window.maxForce);
}

/// The index of the object that is the nearest to a place.
function nearestTo(objects, place) {
  const distances = objects.map(({ position }) => distance(position, place));
  return distances.indexOf(Math.min(...distances));
}

test('a box of the live plant is pushed, and shown where the robot sees it', limit, async () => {
  const { page, seen } = await openSites('--config', config);
  // A busy machine is late at first.
  const isLeadRight = (state) => state?.link.lead > 0.2 && state.link.lead < 0.5;
  await until(async () => isLeadRight(await stateOf(page)), 'a lead of 0.2 to 0.5 s', 30_000);
  const first = await stateOf(page);
  const body = nearestTo(first.objects, first.proxy);
  const start = first.link.robot.objects[body].position;
  // As the page says: the ring, towards the body beside which the tool starts, but not to hit it.
  const goal = [...first.objects[body].position.slice(0, 2), first.proxy[2]];
  const ring = await page.locator('#handle').boundingBox();
  await page.mouse.move(ring.x + ring.width / 2, ring.y + ring.height / 2);
  await page.mouse.down();
  const maxForce = await watchForce(page);
  const pushed = move(page, first.proxy, goal, 4, 0.003);
  await until(
    async () => {
      const robot = (await stateOf(page))?.link.robot; // a busy machine misses states
      const moved = robot ? distance(robot.objects[body].position, start) : 0;
      return (await maxForce()) > 0.5 && moved > 0.02;
    },
    "the robot's box pushed, and a force on the hand",
    60_000,
  );
  await screenshot(page, 'link-pushing');
  await pushed;
  await page.mouse.up();
  await page.waitForTimeout(1500); // a round trip, and the last corrections
  const { objects, link } = await stateOf(page);
  const apart = distance(link.robot.objects[body].position, objects[body].position);
  assert.ok(apart < 0.003, `shown and tracked differ by ${1000 * apart} mm`);
  // What the robot's camera sees, with its age: the delay back, at least.
  await page.locator('#camera-toggle').click();
  await page.waitForFunction(() => document.querySelector('#picture img').naturalWidth > 0);
  const caption = await page.locator('#picture .caption').textContent();
  const [, age] = caption.match(/^Robot's camera, ([\d.]+) s ago/);
  assert.ok(Number(age) >= 0.2 && Number(age) < 2, caption);
  const { picture } = (await stateOf(page)).link;
  await until(async () => (await stateOf(page)).link.picture > picture + 2, 'newer pictures');
  await screenshot(page, 'link-camera');
  assert.deepEqual(seen.errors, []);
});

/// The silence [s] of the link in the first frame that shows it.
const shownSilence = (page) =>
  page.evaluate(
    () =>
      new Promise((resolve) => {
        const look = () => {
          if (document.getElementById('link-alert').hidden) return requestAnimationFrame(look);
          resolve(window.__pcavr.state.link.silence);
        };
        look();
      }),
  );

async function resumed(page) {
  await page.waitForFunction(() => window.__pcavr.state?.link?.isConnected);
  await page.waitForFunction(() => document.getElementById('link-alert').hidden);
}

test('silence is shown within 0.5 s, the clutch opens, and the link resumes', limit, async () => {
  const { robot, page } = await openSites();
  robot.signal('SIGSTOP');
  const silence = await shownSilence(page);
  await screenshot(page, 'link-silent');
  const headerText = () => page.locator('#connection').textContent();
  assert.equal(await headerText(), "no link to the robot's site");
  assert.ok(silence > 0.2 && silence < 0.5, `shown after ${silence} s`);
  assert.equal((await stateOf(page)).isEngaged, false);
  robot.signal('SIGCONT');
  await resumed(page);
  assert.equal(await headerText(), 'connected');
  // The robot's site ends, and starts again.
  await robot.stop();
  await shownSilence(page);
  sites.push(await startRobot(scene.scene, robot.ready.port));
  await resumed(page);
});

test('an emergency stop reaches the robot, and only its release ends it', limit, async () => {
  const { page } = await openSites('--config', config);
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
