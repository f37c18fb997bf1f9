// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { BufferAttribute, BufferGeometry, Line, type LineBasicMaterial } from 'three';
import type { Vector } from '../protocol';

/// A straight line between two moving points.
export class Segment extends Line {
  private readonly ends = new BufferAttribute(new Float32Array(6), 3);

  constructor(material: LineBasicMaterial) {
    super(new BufferGeometry(), material);
    this.geometry.setAttribute('position', this.ends);
    this.frustumCulled = false; // its bounds are not updated when it moves
  }

  join(from: Readonly<Vector>, to: Readonly<Vector>): void {
    this.ends.setXYZ(0, ...from);
    this.ends.setXYZ(1, ...to);
    this.ends.needsUpdate = true;
  }
}
