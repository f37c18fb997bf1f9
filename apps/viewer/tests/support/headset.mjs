// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// An emulated headset with two controllers, led by a test.
import { createRequire } from 'node:module';
import { frames } from './controller.mjs';

const iwer = createRequire(import.meta.url).resolve('iwer/build/iwer.min.js');

/// For every page of this context from now on.
export async function wearHeadset(context) {
  await context.addInitScript({ path: iwer });
  await context.addInitScript(() => {
    const device = new IWER.XRDevice(IWER.metaQuest3);
    device.installRuntime({ forceInstall: true });
    device.stereoEnabled = true;
    device.position.set(0, 1.6, 0);
    window.__headset = device;
    // The emulator calls all of its poses guessed. Here they are, once a test says so.
    window.__isGuessed = false;
    Object.defineProperty(XRPose.prototype, 'emulatedPosition', { get: () => window.__isGuessed });
    window.__felt = [];
    for (const side of ['left', 'right']) {
      for (const actuator of device.controllers[side].inputSource.gamepad.hapticActuators) {
        const pulse = actuator.pulse.bind(actuator);
        actuator.pulse = (value, milliseconds) => {
          window.__felt.push({ side, value, milliseconds });
          return pulse(value, milliseconds);
        };
      }
    }
  });
}

/// A page in VR that is connected, at the start.
export async function enterVr(stage) {
  const opened = await stage.open();
  const { page } = opened;
  await page.waitForFunction(() => window.__pcavr?.state);
  await page.click('#vr-button:enabled');
  await page.waitForFunction(() => window.__pcavr.vr?.isPresenting);
  await frames(page, 3);
  return opened;
}

/// Where the person is: the head [m] in base, and the heading [rad] of straight ahead.
export function placeOf(page) {
  return page.evaluate(() => {
    const { app, vr } = window.__pcavr;
    const head = app.view.tool.proxy.position.clone();
    const { x, y, z } = window.__headset.position;
    const ahead = head.clone().set(0, 0, -1).applyQuaternion(vr.person.rig.quaternion);
    return {
      head: vr.person.toBase(head.set(x, y, z)).toArray(),
      heading: Math.atan2(ahead.y, ahead.x),
    };
  });
}
