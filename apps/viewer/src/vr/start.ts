// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3, Vector3 } from 'three';

import type { Vector } from '../protocol';
import { operatorSide } from '../scene/first_view';
import type { Level } from './teleport';

// Height of a table: the support's assumed height above a floor that was not scanned [m].
const tableHeight = 0.75;
// A scan that reaches less far below the support shows its edge, not the floor [m].
const floorDepth = 0.3;
// Minimum horizontal distance of the user from the objects [m].
const minDistance = 0.45;
// Angles to the objects from a head that looks at them: below the horizon, and to each side. A head
// pitched 20 degrees down has them near the middle of its view [rad].
const viewDown = (32 * Math.PI) / 180;
const viewAside = (30 * Math.PI) / 180;

/// The parts of a scene that determine where the user stands; all in base.
export interface Ground {
  /// Horizontal surfaces that objects stand on.
  supports: Level[];
  /// The scan's lowest point [m]; undefined without a scan.
  scanMinZ: number | undefined;
  /// Positions of the movable objects.
  objects: Vector3[];
  /// Positions of the cameras that have seen the scene [m].
  cameras: readonly Vector[];
}

/// The floor's height [m]: the scan's lowest point, or a table's height below the lowest support.
export function floorHeight(ground: Ground): number {
  const support = Math.min(...ground.supports.map((s) => s.z), Infinity);
  const scanMinZ = ground.scanMinZ ?? Infinity;
  if (support === Infinity) return scanMinZ === Infinity ? -tableHeight : scanMinZ;
  return scanMinZ < support - floorDepth ? scanMinZ : support - tableHeight;
}

/// How far beyond the scene a user may teleport [m]: a few steps around a table.
const reach = 2;

/// The floor on which a user may stand: around the robot, the objects, their supports and the cameras.
export function floorLevel(ground: Ground): Level {
  const points = [
    new Vector3(),
    ...ground.objects,
    ...ground.cameras.map((camera) => new Vector3(...camera)),
    ...ground.supports.flatMap(({ outline }) => (outline ?? []).map((c) => new Vector3(...c))),
  ];
  const { min, max } = new Box3().setFromPoints(points).expandByScalar(reach);
  const z = floorHeight(ground);
  const outline: Vector[] = [
    [min.x, min.y, z],
    [max.x, min.y, z],
    [max.x, max.y, z],
    [min.x, max.y, z],
  ];
  return { z, outline };
}

/// The user's initial pose: on the floor where the operator stands, facing the objects, so far from
/// them that they are in view of a head at `eyeHeight` [m] above the floor that looks slightly down.
export function startPose(ground: Ground, eyeHeight: number): { foot: Vector3; heading: number } {
  const foot = new Vector3(0, 0, floorHeight(ground));
  const { objects } = ground;
  if (objects.length === 0) return { foot, heading: 0 };
  const mean = new Vector3();
  for (const object of objects) mean.addScaledVector(object, 1 / objects.length);
  const side = operatorSide(mean.toArray(), ground.cameras);
  const across = new Vector3(-side.y, side.x, 0);
  const offsets = objects.map((object) => object.clone().sub(mean));
  const nearest = Math.max(...offsets.map((offset) => offset.dot(side)));
  const halfWidth = Math.max(...offsets.map((offset) => Math.abs(offset.dot(across))));
  const drop = foot.z + eyeHeight - mean.z;
  const distance = Math.max(
    drop / Math.tan(viewDown),
    halfWidth / Math.tan(viewAside),
    nearest + minDistance,
  );
  foot.x = mean.x + distance * side.x;
  foot.y = mean.y + distance * side.y;
  return { foot, heading: Math.atan2(-side.y, -side.x) };
}
