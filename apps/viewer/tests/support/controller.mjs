// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Moves an emulated controller, in the headset's space: y up, -z forward.

import { until } from './live.mjs';

/// Moves a controller by `delta` [m] at `speed` [m/s] of wall time, independent of the frame rate.
export function moveBy(page, side, delta, speed) {
  return page.evaluate(
    ([hand, by, metresPerSecond]) =>
      new Promise((resolve) => {
        const { position } = window.__headset.controllers[hand];
        const start = [position.x, position.y, position.z];
        const seconds = Math.hypot(...by) / metresPerSecond;
        const begin = performance.now();
        const timer = setInterval(() => {
          const fraction = Math.min(1, (performance.now() - begin) / 1000 / seconds);
          position.set(...start.map((value, i) => value + fraction * by[i]));
          if (fraction < 1) return;
          clearInterval(timer);
          resolve();
        }, 5);
      }),
    [side, delta, speed],
  );
}

/// Rotates a direction from base to the headset's space, whose forward is `heading` [rad] about z.
export function toHeadset([x, y, z], heading) {
  const c = Math.cos(heading);
  const s = Math.sin(heading);
  return [s * x - c * y, z, -c * x - s * y];
}

/// Presses or releases a button ("squeeze", "trigger", "a-button", ...), and waits some frames.
export async function press(page, side, button, isPressed) {
  await page.evaluate(
    ([hand, name, value]) => window.__headset.controllers[hand].updateButtonValue(name, value),
    [side, button, isPressed ? 1 : 0],
  );
  await frames(page, 3);
}

/// Closes the right hand's clutch. A page that is just being opened may lose the focus, which opens
/// the clutch: the press is repeated.
export async function closeClutch(page, world) {
  const reason = () => page.evaluate(() => window.__pcavr.vr.clutch.openReason);
  for (let i = 0; i < 3 && !world.state.isEngaged; ++i) {
    await press(page, 'right', 'squeeze', false);
    await press(page, 'right', 'squeeze', true);
    await until(() => world.state.isEngaged, 'the clutch', 3000).catch(() => {});
  }
  if (!world.state.isEngaged) throw new Error(`the clutch does not close: ${await reason()}`);
}

/// Deflects a thumbstick, and returns it to the centre.
export async function flick(page, side, x, y) {
  const set = (to) =>
    page.evaluate(
      ([hand, axes]) => window.__headset.controllers[hand].updateAxes('thumbstick', ...axes),
      [side, to],
    );
  await set([x, y]);
  await frames(page, 4);
  await set([0, 0]);
  await frames(page, 4);
}

/// Waits for a number of headset frames.
export function frames(page, count) {
  return page.evaluate(
    (n) =>
      new Promise((resolve) => {
        const next = () => (n-- > 0 ? session.requestAnimationFrame(next) : resolve());
        const session = window.__headset.activeSession;
        next();
      }),
    count,
  );
}
