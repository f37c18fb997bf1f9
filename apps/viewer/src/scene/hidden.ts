// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Ray, Vector3 } from 'three';
import type { Body } from './bodies';
import { cornersOf } from './box';

const margin = 0.002; // [m] of a box by which two bodies that touch do not hide one another

/// Whether all of the body's box that could be seen is behind the boxes of other bodies: its centre and
/// the corners of its box, from `eye` (the scene's coordinates).
export function isHidden(body: Body, others: readonly Body[], eye: Vector3): boolean {
  if (body.box.isEmpty()) return false;
  const points = [body.box.getCenter(new Vector3()), ...cornersOf(body.box)];
  return points.every((point) => {
    const at = body.solid.localToWorld(point);
    return others.some((other) => other !== body && blocks(other, eye, at));
  });
}

/// Whether the body's box is between the two points.
function blocks(body: Body, eye: Vector3, point: Vector3): boolean {
  if (body.box.isEmpty()) return false;
  const box = body.box.clone().expandByScalar(-margin);
  const to = body.solid.worldToLocal(point.clone());
  // Inside of a tray's or a shelf's box: that says nothing.
  if (box.isEmpty() || box.containsPoint(to)) return false;
  const from = body.solid.worldToLocal(eye.clone());
  const hit = new Ray(from, to.clone().sub(from).normalize()).intersectBox(box, new Vector3());
  return hit !== null && hit.distanceTo(from) < to.distanceTo(from);
}
