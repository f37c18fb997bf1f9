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
// Tangents of the angles to either side of the head's direction up to which both eyes of a headset
// see: an eye sees less far towards the other one.
const viewWidth = 0.8;
const viewHeight = 0.95;
const maxPull = 0.3; // [m] into the view: of a hand farther out of view the sheet stays there

/// Of a rectangle that faces the head, upright (faceHead) [m].
export interface SheetSize {
  width: number;
  height: number;
}

/// Whether a sheet around `center` hides a part of a ball from the head, or is hidden by it.
export function hides(center: Vector3, size: SheetSize, head: Vector3, ball: Ball): boolean {
  const forward = center.clone().sub(head);
  const right = rightOf(forward);
  const up = right.clone().cross(forward).normalize();
  const toBall = ball.center.clone().sub(head);
  const distance = forward.length();
  const ahead = toBall.dot(forward) / distance;
  if (ahead <= 0) return false;
  const radius = Math.asin(Math.min(1, ball.radius / toBall.length()));
  const isBeside = (axis: Vector3, extent: number) =>
    Math.abs(Math.atan2(toBall.dot(axis), ahead)) >
    Math.atan2(extent / 2, distance) + radius + margin;
  return !isBeside(right, size.width) && !isBeside(up, size.height);
}

function rightOf(forward: Vector3): Vector3 {
  return new Vector3(-forward.z, 0, forward.x).normalize();
}

/// The head's position and the direction that it faces, in the headset's space.
export interface Gaze {
  head: Vector3;
  forward: Vector3; // of length 1
}

/// Whether both eyes see all of a sheet.
export function isInView(center: Vector3, size: SheetSize, { head, forward }: Gaze): boolean {
  const toCenter = center.clone().sub(head);
  const [sheetRight, right] = [rightOf(toCenter), rightOf(forward)];
  const sheetUp = sheetRight.clone().cross(toCenter).normalize();
  const up = right.clone().cross(forward);
  return [-0.5, 0.5].every((x) =>
    [-0.5, 0.5].every((y) => {
      const corner = toCenter.clone().addScaledVector(sheetRight, x * size.width);
      corner.addScaledVector(sheetUp, y * size.height);
      const ahead = corner.dot(forward);
      return (
        Math.abs(corner.dot(right)) < viewWidth * ahead &&
        Math.abs(corner.dot(up)) < viewHeight * ahead
      );
    }),
  );
}

/// The place where a sheet hides none of the balls and is in the view of both eyes: `center`, or
/// the nearest one to the side `outward` (+1 right, -1 left) of the head's view, below, to the
/// other side or above (also obliquely). If there is none, one where it hides none.
export function clearPlace(
  center: Vector3,
  size: SheetSize,
  gaze: Gaze,
  balls: readonly Ball[],
  outward: number,
): Vector3 {
  const { head } = gaze;
  const isClear = (place: Vector3) => !balls.some((ball) => hides(place, size, head, ball));
  if (isClear(center) && isInView(center, size, gaze)) return center;
  const right = rightOf(center.clone().sub(head));
  const directions = [
    right.clone().multiplyScalar(outward),
    new Vector3(0, -1, 0),
    right.clone().multiplyScalar(-outward),
    new Vector3(0, 1, 0),
    right
      .clone()
      .multiplyScalar(-0.5 * outward)
      .add(new Vector3(0, 1, 0)),
  ];
  const places = Array.from({ length: maxSteps }, (_, i) =>
    directions.map((direction) => center.clone().addScaledVector(direction, (i + 1) * step)),
  ).flat();
  const clear = places.filter(isClear);
  const seen = clear.find((place) => isInView(place, size, gaze));
  if (!isClear(center)) return seen ?? clear[0] ?? center;
  return seen && seen.distanceTo(center) <= maxPull ? seen : center;
}
