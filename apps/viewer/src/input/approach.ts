// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Ray, Vector3, type Box3 } from 'three';
import { midHeight, type Obstacle } from './push_height';

const speed = 0.6; // [m/s]
const gap = 0.005; // [m] between the tool and the body at the end
const clearance = 0.03; // [m] over the highest body
const tolerance = 0.015; // [m] from a waypoint to the tool
const timeout = 1; // [s] for the tool to follow to a waypoint: something else may be in its path

/// Where a tool stands to push a body in a level direction (a unit vector in base): behind the
/// pressed point of its surface, at its mid-height.
export function placeBehind(
  pressed: Vector3,
  direction: Vector3,
  radius: number,
  { box }: Obstacle,
): Vector3 {
  const start = box.clampPoint(pressed, new Vector3()).setZ(midHeight(box, radius));
  const around = box.clone().expandByScalar(radius + gap);
  const back = new Ray(start, direction.clone().negate());
  return back.intersectBox(around, new Vector3()) ?? start;
}

function isFree(from: Vector3, to: Vector3, boxes: readonly Box3[]): boolean {
  const length = from.distanceTo(to);
  const ray = new Ray(from, to.clone().sub(from).normalize());
  return boxes.every((box) => {
    const hit = ray.intersectBox(box, new Vector3());
    return !hit || hit.distanceTo(from) > length;
  });
}

/// Moves the tool to a place without touching a body: straight, or over all of them.
export class Approach {
  private readonly waypoints: Vector3[];
  private waited = 0; // [s] at the first waypoint

  constructor(from: Vector3, to: Vector3, radius: number, obstacles: readonly Obstacle[]) {
    const boxes = obstacles
      .filter(({ box }) => !box.isEmpty())
      .map(({ box }) => box.clone().expandByScalar(0.99 * radius));
    const top = Math.max(from.z, to.z, ...boxes.map(({ max }) => max.z + clearance));
    const over = [from.clone().setZ(top), to.clone().setZ(top), to.clone()];
    this.waypoints = isFree(from, to, boxes) ? [to.clone()] : over;
  }

  get isDone(): boolean {
    return this.waypoints.length === 0;
  }

  /// Moves `tip` on; `tool`: where the tool is that follows it.
  update(seconds: number, tip: Vector3, tool: Vector3): void {
    const [next] = this.waypoints;
    if (!next) return;
    const rest = next.clone().sub(tip);
    tip.add(rest.clampLength(0, speed * seconds));
    if (tip.distanceTo(next) > 1e-6) return;
    this.waited += seconds;
    if (tool.distanceTo(next) > tolerance && this.waited < timeout) return;
    this.waypoints.shift();
    this.waited = 0;
  }
}
