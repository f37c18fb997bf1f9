// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { nearestRow } from '../ui/plot_axes';
import { number } from './number';
import type { Series } from './report_data';

interface Point {
  x: number;
  y: number;
}

/// The points of a series, without its gaps.
export function pointsOf({ x, y }: Series): Point[] {
  return x.flatMap((at, i) => {
    const value = y[i];
    return at !== null && value !== null ? [{ x: at, y: value }] : [];
  });
}

export interface ValueRow extends Point {
  values: string[]; // a line for each series
}

/// All series' values at each x of the longest one. A series has a value where one of its points is
/// not farther away than its points are from each other.
export function valuesByX(series: readonly Series[]): ValueRow[] {
  const all = series.map((one) => {
    const points = pointsOf(one);
    const times = points.map(({ x }) => x);
    const reach = (1.5 * (times[times.length - 1] - times[0])) / Math.max(times.length - 1, 1);
    return { label: one.label, points, times, reach };
  });
  const longest = all.reduce((a, b) => (b.points.length > a.points.length ? b : a), all[0]);
  return (longest?.points ?? []).map(({ x, y }) => {
    const values = all.map(({ label, points, times, reach }) => {
      const nearest = points[nearestRow(times, x)];
      const isNear = nearest && Math.abs(nearest.x - x) <= reach;
      return `${label} ${isNear ? number(nearest.y) : '–'}`;
    });
    return { x, y, values };
  });
}
