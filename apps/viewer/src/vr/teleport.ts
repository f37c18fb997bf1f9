// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  Vector3,
} from 'three';
import { isInside, type Outline } from '../scene/outline';

/// A horizontal surface in base to teleport onto; without an outline it is unbounded.
export interface Level {
  z: number;
  outline: Outline | null;
}

// Of the ballistic arc: fast enough to cross a room, slow enough to aim at one's feet [m/s].
const launchSpeed = 5;
const gravity = 9.81;
const pathSteps = 40;
const flightTime = 2; // [s]

/// The ballistic arc (parabola) from `from` along `direction` (unit, base), in a world shown
/// `scale` times larger.
export function ballisticPath(from: Vector3, direction: Vector3, scale: number): Vector3[] {
  const path: Vector3[] = [];
  for (let i = 0; i <= pathSteps; ++i) {
    const t = (flightTime * i) / pathSteps;
    const point = from.clone().addScaledVector(direction, (launchSpeed * t) / scale);
    point.z -= (0.5 * gravity * t * t) / scale;
    path.push(point);
  }
  return path;
}

/// The first point where a path passes down through a level, and the path up to it.
export function findLanding(
  path: Vector3[],
  levels: Level[],
): { point: Vector3; path: Vector3[] } | undefined {
  for (let i = 1; i < path.length; ++i) {
    const before = path[i - 1];
    const after = path[i];
    let best: Vector3 | undefined;
    for (const level of levels) {
      if (before.z < level.z || after.z >= level.z) continue;
      const fraction = (before.z - level.z) / (before.z - after.z);
      const point = before.clone().lerp(after, fraction);
      if (level.outline && !isInside(point.x, point.y, level.outline)) continue;
      if (best === undefined || point.z > best.z) best = point;
    }
    if (best !== undefined) return { point: best, path: [...path.slice(0, i), best] };
  }
  return undefined;
}

/// The arc, and a ring at its landing point.
export class TeleportView {
  readonly group = new Group();
  private readonly points = new BufferAttribute(new Float32Array(3 * (pathSteps + 2)), 3);
  private readonly arc = new BufferGeometry();
  private readonly ring: Mesh;

  constructor() {
    this.arc.setAttribute('position', this.points);
    const line = new Line(this.arc, new LineBasicMaterial({ color: 0x39a0ff }));
    line.frustumCulled = false;
    this.ring = new Mesh(
      new RingGeometry(0.16, 0.2, 48),
      new MeshBasicMaterial({ color: 0x39a0ff, side: 2, transparent: true, opacity: 0.8 }),
    );
    this.group.add(line, this.ring);
    this.group.visible = false;
    this.group.name = 'teleport';
  }

  show(path: Vector3[], landing: Vector3, scale: number): void {
    path.forEach((p, i) => this.points.setXYZ(i, p.x, p.y, p.z));
    this.points.needsUpdate = true;
    this.arc.setDrawRange(0, path.length);
    // Above the surface, against z-fighting.
    this.ring.position.copy(landing).z += 0.004 / scale;
    this.ring.scale.setScalar(1 / scale);
    this.group.visible = true;
  }

  hide(): void {
    this.group.visible = false;
  }
}
