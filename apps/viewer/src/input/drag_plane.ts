// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Plane, Vector3, type PerspectiveCamera, type Ray } from 'three';
import { levelDirection } from './navigation';

export type PlaneKind = 'level' | 'upright' | 'view';

const minSlope = 0.12; // sine of ray against plane: seen flatter, a pixel would be many centimetres
const farthest = 3; // [m] from where the drag began: beyond, the pointer is near the horizon

/// The plane through the tool on which a pointer drags it. World frame.
export class DragPlane {
  private readonly plane: Plane;
  private readonly grip: Vector3; // from the ray's hit to the tool

  private constructor(
    private readonly start: Vector3,
    normal: Vector3,
    ray: Ray,
  ) {
    this.plane = new Plane().setFromNormalAndCoplanarPoint(normal, start);
    const hit = ray.intersectPlane(this.plane, new Vector3());
    this.grip = hit ? start.clone().sub(hit) : new Vector3();
  }

  /// A level plane seen almost from its edge is no use: then the picture's own plane stands in.
  static through(tool: Vector3, kind: PlaneKind, camera: PerspectiveCamera, ray: Ray): DragPlane {
    const view = camera.getWorldDirection(new Vector3());
    const up = new Vector3(0, 1, 0);
    const isFlat = Math.abs(ray.direction.y) < minSlope;
    const normals = { level: isFlat ? view : up, upright: levelDirection(camera), view };
    return new DragPlane(tool.clone(), normals[kind], ray);
  }

  /// Where the pointer's ray takes the tool; null where it takes it nowhere.
  move(ray: Ray): Vector3 | null {
    const hit = ray.intersectPlane(this.plane, new Vector3());
    if (!hit) return null;
    const tool = hit.add(this.grip);
    return tool.distanceTo(this.start) <= farthest ? tool : null;
  }
}
