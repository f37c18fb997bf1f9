// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Plane, Vector3, type PerspectiveCamera, type Ray } from 'three';
import { horizontalDirection } from './navigation';

export type PlaneKind = 'horizontal' | 'vertical' | 'view';

const minIncidence = 0.12; // sine of ray to plane angle: below, a pixel spans many centimetres
const maxDistance = 3; // [m] from the drag's start: beyond, the pointer is near the horizon

/// The plane through the tool on which a pointer drags it. World frame.
export class DragPlane {
  private readonly plane: Plane;
  private readonly grabOffset: Vector3; // from the ray's hit to the tool

  private constructor(
    private readonly start: Vector3,
    normal: Vector3,
    ray: Ray,
  ) {
    this.plane = new Plane().setFromNormalAndCoplanarPoint(normal, start);
    const hit = ray.intersectPlane(this.plane, new Vector3());
    this.grabOffset = hit ? start.clone().sub(hit) : new Vector3();
  }

  /// A horizontal plane at grazing incidence is ill-conditioned: then the view plane is used.
  static through(tool: Vector3, kind: PlaneKind, camera: PerspectiveCamera, ray: Ray): DragPlane {
    const view = camera.getWorldDirection(new Vector3());
    const up = new Vector3(0, 1, 0);
    const isGrazing = Math.abs(ray.direction.y) < minIncidence;
    const horizontal = isGrazing ? view : up;
    const normals = { horizontal, vertical: horizontalDirection(camera), view };
    return new DragPlane(tool.clone(), normals[kind], ray);
  }

  /// The tool's position for a pointer ray; null without an intersection in reach.
  move(ray: Ray): Vector3 | null {
    const hit = ray.intersectPlane(this.plane, new Vector3());
    if (!hit) return null;
    const tool = hit.add(this.grabOffset);
    return tool.distanceTo(this.start) <= maxDistance ? tool : null;
  }
}
