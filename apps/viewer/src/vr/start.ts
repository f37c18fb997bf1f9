// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';

import type { Level } from './teleport';

// A table's height: what stands between floor and support where the scan does not show a floor [m].
const tableHeight = 0.75;
// A scan that goes less deep than this below the support shows the support's own edge [m].
const floorDepth = 0.3;
// Whoever stands nearer than this to the things has them under their chin [m].
const nearest = 0.45;

/// What of a scene says where to stand; all in base.
export interface Ground {
  /// Level surfaces that things stand on.
  supports: Level[];
  /// The scan's lowest point [m]; undefined without a scan.
  lowest: number | undefined;
  /// Where the things are that one comes for.
  things: Vector3[];
}

/// The floor's height [m]: the scan's lowest point, or a table's height below the lowest support.
export function floorOf(ground: Ground): number {
  const support = Math.min(...ground.supports.map((s) => s.z), Infinity);
  const lowest = ground.lowest ?? Infinity;
  if (support === Infinity) return lowest === Infinity ? -tableHeight : lowest;
  return lowest < support - floorDepth ? lowest : support - tableHeight;
}

/// Where a person begins: on the floor at the robot's base, facing the things.
export function startingPlace(ground: Ground): { foot: Vector3; heading: number } {
  const foot = new Vector3(0, 0, floorOf(ground));
  if (ground.things.length === 0) return { foot, heading: 0 };
  const middle = new Vector3();
  for (const thing of ground.things) middle.addScaledVector(thing, 1 / ground.things.length);
  const away = Math.hypot(middle.x, middle.y);
  // Right above the base there is no direction: along x, as the robot looks.
  const heading = away < 0.05 ? 0 : Math.atan2(middle.y, middle.x);
  if (away < nearest) {
    foot.x = middle.x - nearest * Math.cos(heading);
    foot.y = middle.y - nearest * Math.sin(heading);
  }
  return { foot, heading };
}
