// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector } from '../protocol';

/// Corners of a level surface [m], one after the other round it, in base.
export type Outline = readonly Readonly<Vector>[];

/// The mean of its corners' heights [m].
export function heightOf(outline: Outline): number {
  return outline.reduce((sum, corner) => sum + corner[2], 0) / outline.length;
}

/// Whether a place lies in an outline, seen from above: a ray along x leaves it once more than it
/// enters.
export function isInside(x: number, y: number, outline: Outline): boolean {
  let isIn = false;
  outline.forEach((a, i) => {
    const b = outline[(i + 1) % outline.length];
    if (a[1] > y !== b[1] > y && x < a[0] + ((b[0] - a[0]) * (y - a[1])) / (b[1] - a[1]))
      isIn = !isIn;
  });
  return isIn;
}
