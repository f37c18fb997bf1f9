// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  DoubleSide,
  Group,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  Raycaster,
  RingGeometry,
} from 'three';
import type { Vector } from '../protocol';
import type { Body } from './bodies';
import { heightOf, isInside, type Outline } from './outline';
import { Segment } from './segment';

const color = '#ffffff';
const lift = 0.001; // [m] of the foot above the surface, against z-fighting

/// A vertical line from the tool down to the body or the support below it: a depth cue on a flat
/// screen. All in base.
export class PlumbLine {
  readonly group = new Group();
  private readonly line: Segment;
  private readonly foot: Mesh;
  private readonly ray = new Raycaster();

  constructor(private readonly base: Group) {
    const faint = { color, transparent: true, opacity: 0.7 };
    this.line = new Segment(new LineBasicMaterial(faint));
    const ring = new RingGeometry(0.7, 1, 32);
    this.foot = new Mesh(ring, new MeshBasicMaterial({ ...faint, side: DoubleSide }));
    this.group.add(this.line, this.foot);
    base.add(this.group);
  }

  /// `radius` [m] of the tool.
  show(
    tool: Readonly<Vector>,
    radius: number,
    bodies: readonly Body[],
    supports: readonly Outline[],
  ): void {
    const [x, y, z] = tool;
    const below = Math.max(this.bodyBelow(tool, bodies), supportBelow(tool, supports));
    this.group.visible = Number.isFinite(below) && z - below > radius;
    if (!this.group.visible) return;
    this.line.join(tool, [x, y, below]);
    this.foot.position.set(x, y, below + lift);
    this.foot.scale.setScalar(radius);
  }

  private bodyBelow(tool: Readonly<Vector>, bodies: readonly Body[]): number {
    this.base.updateWorldMatrix(true, false);
    this.ray.ray.origin.fromArray(tool).applyMatrix4(this.base.matrixWorld);
    this.ray.ray.direction.set(0, 0, -1).transformDirection(this.base.matrixWorld);
    const hits = this.ray.intersectObjects(bodies.map((body) => body.solid));
    const hit = hits.find(({ object }) => object instanceof Mesh);
    return hit ? this.base.worldToLocal(hit.point.clone()).z : -Infinity;
  }
}

/// The height [m] of the highest support below a point; -Infinity outside of all outlines.
export function supportBelow(point: Readonly<Vector>, outlines: readonly Outline[]): number {
  let highest = -Infinity;
  for (const outline of outlines) {
    const height = heightOf(outline);
    if (height < point[2] && height > highest && isInside(point[0], point[1], outline))
      highest = height;
  }
  return highest;
}
