// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Object3D, Vector3 } from 'three';

/// Turns a sheet to the head, upright; in the headset's space.
export function faceHead(sheet: Object3D, head: Vector3): void {
  const towards = head.clone().sub(sheet.position);
  const flat = Math.hypot(towards.x, towards.z);
  sheet.rotation.set(-Math.atan2(towards.y, flat), Math.atan2(towards.x, towards.z), 0, 'YXZ');
  sheet.updateMatrix();
}
