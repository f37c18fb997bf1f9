// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// An emulated headset with two controllers, moved by a test.
import { createRequire } from 'node:module';
import { frames } from './controller.mjs';

const iwer = createRequire(import.meta.url).resolve('iwer/build/iwer.min.js');

/// Installs the emulator in all future pages of this context.
export async function installHeadset(context) {
  await context.addInitScript({ path: iwer });
  await context.addInitScript(() => {
    const device = new IWER.XRDevice(IWER.metaQuest3);
    device.installRuntime({ forceInstall: true });
    device.stereoEnabled = true;
    device.position.set(0, 1.6, 0);
    window.__headset = device;
    // The emulator marks all of its poses as emulated; here only while a test requests it.
    window.__isEmulated = false;
    Object.defineProperty(XRPose.prototype, 'emulatedPosition', { get: () => window.__isEmulated });
    window.__hapticPulses = [];
    for (const side of ['left', 'right']) {
      for (const actuator of device.controllers[side].inputSource.gamepad.hapticActuators) {
        const pulse = actuator.pulse.bind(actuator);
        actuator.pulse = (value, milliseconds) => {
          window.__hapticPulses.push({ side, value, milliseconds });
          return pulse(value, milliseconds);
        };
      }
    }
  });
}

/// Opens a page, connects it and enters VR.
export async function enterVr(stage) {
  const opened = await stage.open();
  const { page } = opened;
  await page.waitForFunction(() => window.__pcavr?.state);
  await page.click('#vr-button:enabled');
  await page.waitForFunction(() => window.__pcavr.vr?.isPresenting);
  await frames(page, 3);
  return opened;
}

/// The user's head position [m] in base, and heading [rad].
export function placeOf(page) {
  return page.evaluate(() => {
    const { app, vr } = window.__pcavr;
    const head = app.view.tool.proxy.position.clone();
    const { x, y, z } = window.__headset.position;
    const forward = head.clone().set(0, 0, -1).applyQuaternion(vr.person.rig.quaternion);
    return {
      head: vr.person.toBase(head.set(x, y, z)).toArray(),
      heading: Math.atan2(forward.y, forward.x),
    };
  });
}
