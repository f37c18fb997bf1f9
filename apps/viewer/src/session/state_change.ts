// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';

// What no eye sees: a hundredth of a millimetre, a turn of as much at a metre, and a hundredth of a
// newton (a tenth of a millimetre of an arrow).
const minMotion = 1e-5; // [m] and of a quaternion
const minForce = 1e-2; // [N]

/// True if a picture of `b` would be another than one of `a`.
export function looksDifferent(a: LiveState, b: LiveState): boolean {
  if (a.objects.length !== b.objects.length || a.pulses !== b.pulses) return true;
  if (a.isEngaged !== b.isEngaged || a.isOnHold !== b.isOnHold) return true;
  if (a.hasTool !== b.hasTool || a.isToolTaken !== b.isToolTaken) return true;
  if (a.touchesScan !== b.touchesScan || a.touchedObject !== b.touchedObject) return true;
  return (
    differ(a.hip, b.hip, minMotion) ||
    differ(a.proxy, b.proxy, minMotion) ||
    differ(a.force, b.force, minForce) ||
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

function differ(a: readonly number[], b: readonly number[], tolerance: number): boolean {
  return a.some((value, i) => !(Math.abs(value - b[i]) <= tolerance));
}
