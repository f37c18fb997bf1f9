// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { Vector } from '../protocol';

const nearSide = Math.PI / 3; // [rad] cameras within this angle of a side have seen it
const minRobotShare = 0.25; // of the cameras: with fewer, the robot's side of the scan has holes
const minOffset = 0.05; // [m] a position nearer to the centre than this has no direction

/// The horizontal unit vector in base from the bodies' centre to where the operator stands: the
/// robot's side, unless the cameras have hardly seen the scene from there; then the side that most
/// of them have seen. `center` and `cameras` in base [m].
export function operatorSide(center: Readonly<Vector>, cameras: readonly Vector[]): Vector3 {
  const robot = sideOf([0, 0, 0], center) ?? new Vector3(-1, 0, 0);
  const seen = cameras.map((camera) => sideOf(camera, center)).filter((side) => side !== null);
  const near = (side: Vector3) => seen.filter((other) => other.angleTo(side) < nearSide);
  if (near(robot).length >= minRobotShare * seen.length) return robot;
  const best = seen.reduce((a, b) => (near(b).length > near(a).length ? b : a));
  const sum = near(best).reduce((total, side) => total.add(side), new Vector3());
  return sum.length() > 0 ? sum.normalize() : best;
}

function sideOf(point: Readonly<Vector>, center: Readonly<Vector>): Vector3 | null {
  const side = new Vector3(point[0] - center[0], point[1] - center[1], 0);
  return side.length() < minOffset ? null : side.normalize();
}

export interface Framing {
  eye: Vector3;
  target: Vector3; // at the mean depth of the points
}

/// The nearest eye that looks along `-back` (unit) and has all `points` in its frustum, whose
/// half-angles have the tangents `tangents` (right, up), and in the middle of the picture.
/// Coordinates with y up.
export function framePoints(
  points: readonly Vector3[],
  back: Vector3,
  tangents: { right: number; up: number },
): Framing {
  const right = new Vector3(0, 1, 0).cross(back).normalize();
  const up = back.clone().cross(right);
  const depths = points.map((point) => point.dot(back));
  const across = (axis: Vector3) => points.map((point) => point.dot(axis));
  const [x, y] = [across(right), across(up)];
  const eyeDepth = Math.max(
    nearestDepth(x, depths, tangents.right),
    nearestDepth(y, depths, tangents.up),
  );
  const at = (depth: number) =>
    new Vector3()
      .addScaledVector(right, middleOf(x, depths, eyeDepth))
      .addScaledVector(up, middleOf(y, depths, eyeDepth))
      .addScaledVector(back, depth);
  const mean = depths.reduce((a, b) => a + b, 0) / depths.length;
  return { eye: at(eyeDepth), target: at(mean) };
}

/// A point at (x, z) is in the picture where |x - eye.x| <= tangent (eye.z - z): two half-planes a
/// point, of which only the outermost of each side count.
function nearestDepth(x: readonly number[], z: readonly number[], tangent: number): number {
  const outermost = (sign: number) =>
    x.reduce((max, value, i) => Math.max(max, sign * value + tangent * z[i]), -Infinity);
  return (outermost(1) + outermost(-1)) / (2 * tangent);
}

/// The eye's x from which the points reach as far to both sides of the picture, by bisection.
function middleOf(x: readonly number[], z: readonly number[], eyeDepth: number): number {
  let [low, high] = [Math.min(...x), Math.max(...x)];
  for (let i = 0; i < 40; ++i) {
    const eye = (low + high) / 2;
    const seen = x.map((value, k) => (value - eye) / (eyeDepth - z[k]));
    if (Math.max(...seen) > -Math.min(...seen)) low = eye;
    else high = eye;
  }
  return (low + high) / 2;
}
