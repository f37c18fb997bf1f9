// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';

import type { Level } from './teleport';

// Height of a table: the support's assumed height above a floor that was not scanned [m].
const tableHeight = 0.75;
// A scan that reaches less far below the support shows its edge, not the floor [m].
const floorDepth = 0.3;
// Minimum horizontal distance of the user from the objects [m].
const minDistance = 0.45;

/// The parts of a scene that determine where the user stands; all in base.
export interface Ground {
  /// Horizontal surfaces that objects stand on.
  supports: Level[];
  /// The scan's lowest point [m]; undefined without a scan.
  scanMinZ: number | undefined;
  /// Positions of the movable objects.
  objects: Vector3[];
}

/// The floor's height [m]: the scan's lowest point, or a table's height below the lowest support.
export function floorHeight(ground: Ground): number {
  const support = Math.min(...ground.supports.map((s) => s.z), Infinity);
  const scanMinZ = ground.scanMinZ ?? Infinity;
  if (support === Infinity) return scanMinZ === Infinity ? -tableHeight : scanMinZ;
  return scanMinZ < support - floorDepth ? scanMinZ : support - tableHeight;
}

/// The user's initial pose: on the floor at the robot's base, facing the objects.
export function startPose(ground: Ground): { foot: Vector3; heading: number } {
  const foot = new Vector3(0, 0, floorHeight(ground));
  if (ground.objects.length === 0) return { foot, heading: 0 };
  const mean = new Vector3();
  for (const object of ground.objects) mean.addScaledVector(object, 1 / ground.objects.length);
  const distance = Math.hypot(mean.x, mean.y);
  // Objects above the base give no direction: face along the robot's x.
  const heading = distance < 0.05 ? 0 : Math.atan2(mean.y, mean.x);
  if (distance < minDistance) {
    foot.x = mean.x - minDistance * Math.cos(heading);
    foot.y = mean.y - minDistance * Math.sin(heading);
  }
  return { foot, heading };
}
