// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector } from '../protocol';

/// The corners of a horizontal polygon [m] in order, in base.
export type Outline = readonly Readonly<Vector>[];

/// The mean of its corners' heights [m].
export function heightOf(outline: Outline): number {
  return outline.reduce((sum, corner) => sum + corner[2], 0) / outline.length;
}

/// Point-in-polygon test seen from above, by ray casting along x (even-odd rule).
export function isInside(x: number, y: number, outline: Outline): boolean {
  let isIn = false;
  outline.forEach((a, i) => {
    const b = outline[(i + 1) % outline.length];
    if (a[1] > y !== b[1] > y && x < a[0] + ((b[0] - a[0]) * (y - a[1])) / (b[1] - a[1]))
      isIn = !isIn;
  });
  return isIn;
}
