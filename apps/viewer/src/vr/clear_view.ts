// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';

/// Something that must not be hidden, in the headset's space.
export interface Ball {
  center: Vector3;
  radius: number; // [m]
}

const step = 0.04; // [m]
const maxSteps = 16;
const margin = 0.02; // [rad] between what is shown and what it may not hide

/// Whether a disc around `center` hides a part of a ball from the head, or is hidden by it.
export function hides(center: Vector3, radius: number, head: Vector3, ball: Ball): boolean {
  const [toDisc, toBall] = [center.clone().sub(head), ball.center.clone().sub(head)];
  const angleOf = (r: number, distance: number) => Math.asin(Math.min(1, r / distance));
  const reach = angleOf(radius, toDisc.length()) + angleOf(ball.radius, toBall.length());
  return toDisc.angleTo(toBall) < reach + margin;
}

/// The place nearest to `center` where a disc of `radius` [m] hides none of the balls: to the side
/// `outward` (+1 right, -1 left) of the head's view, or below, or to the other side.
export function clearPlace(
  center: Vector3,
  radius: number,
  head: Vector3,
  balls: readonly Ball[],
  outward: number,
): Vector3 {
  const forward = center.clone().sub(head);
  const right = new Vector3(-forward.z, 0, forward.x).normalize();
  const directions = [
    right.clone().multiplyScalar(outward),
    new Vector3(0, -1, 0),
    right.clone().multiplyScalar(-outward),
  ];
  for (let i = 0; i <= maxSteps; ++i)
    for (const direction of directions) {
      const place = center.clone().addScaledVector(direction, i * step);
      if (!balls.some((ball) => hides(place, radius, head, ball))) return place;
    }
  return center;
}
