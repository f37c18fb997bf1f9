// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';

// Below what is visible: 0.01 mm, a rotation of as much at 1 m, and 0.01 N (0.1 mm of an arrow).
const minMotion = 1e-5; // [m] and of a quaternion
const minForce = 1e-2; // [N]

/// True if a frame of `b` would look different from one of `a`.
export function looksDifferent(a: LiveState, b: LiveState): boolean {
  if (a.objects.length !== b.objects.length || a.pulses !== b.pulses) return true;
  if (a.isEngaged !== b.isEngaged || a.isOnHold !== b.isOnHold) return true;
  if (a.timeScale !== b.timeScale) return true;
  if (a.isStopped !== b.isStopped || a.link?.isConnected !== b.link?.isConnected) return true;
  if (a.hasTool !== b.hasTool || a.isToolTaken !== b.isToolTaken) return true;
  if (a.canUndoReset !== b.canUndoReset) return true;
  if (a.isToolWanted !== b.isToolWanted || a.hasAsked !== b.hasAsked) return true;
  if (a.isRecording !== b.isRecording) return true;
  if (a.touchesScan !== b.touchesScan || a.touchedObject !== b.touchedObject) return true;
  return (
    differ(a.hip, b.hip, minMotion) ||
    differ(a.proxy, b.proxy, minMotion) ||
    differ(a.force, b.force, minForce) ||
    a.arm?.isStopped !== b.arm?.isStopped ||
    measuredDiffers(a, b) ||
    differ(a.arm?.position ?? [], b.arm?.position ?? [], minMotion) ||
    a.objects.some((object, i) => {
      const other = b.objects[i];
      return (
        object.phase !== other.phase ||
        object.isOutsideModel !== other.isOutsideModel ||
        differ(object.position, other.position, minMotion) ||
        differ(object.quaternion, other.quaternion, minMotion)
      );
    })
  );
}

function measuredDiffers({ link: a }: LiveState, { link: b }: LiveState): boolean {
  const [from, to] = [a?.robot, b?.robot];
  if (!from || !to) return Boolean(from) !== Boolean(to);
  return (
    differ(from.tip, to.tip, minMotion) ||
    from.objects.some((object, i) => {
      const other = to.objects[i];
      return (
        object.isTracked !== other.isTracked || differ(object.position, other.position, minMotion)
      );
    })
  );
}

function differ(a: readonly number[], b: readonly number[], tolerance: number): boolean {
  return a.some((value, i) => !(Math.abs(value - b[i]) <= tolerance));
}
