// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { rangeWithoutSpikes } from './plot_spikes';

export const headroom = 1.08;

/// An axis' range: with zero, at least up to `minSpan`; single spikes do not count.
export function axisRange(
  columns: readonly ArrayLike<number>[],
  minSpan: number,
): [number, number] {
  const [low, high] = rangeWithoutSpikes(columns);
  return [low * headroom, Math.max(minSpan, high * headroom)];
}

/// Units of the right axis per unit of the left one: 1, 2 or 5 times a power of ten, so that both
/// axes have round numbers at the same lines and the right curves fit.
export function rightPerLeft(
  left: readonly ArrayLike<number>[],
  right: readonly ArrayLike<number>[],
  minSpan: number,
): number {
  if (right.length === 0) return 1;
  const ratio = axisRange(right, minSpan)[1] / axisRange(left, minSpan)[1];
  const power = 10 ** Math.floor(Math.log10(ratio));
  return [1, 2, 5].map((factor) => factor * power).find((step) => step >= ratio) ?? 10 * power;
}

/// Multiples of 1, 2 or 5 times a power of ten in a range, at most about `count` of them.
export function roundTicks([from, to]: readonly [number, number], count: number): number[] {
  const least = (to - from) / Math.max(count, 1);
  if (!(least > 0) || !Number.isFinite(least)) return [];
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5].map((factor) => factor * power).find((s) => s >= least) ?? 10 * power;
  const [first, last] = [Math.ceil(from / step - 1e-9), Math.floor(to / step + 1e-9)];
  return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

/// The row whose time is nearest; `times` ascend. -1 if there is none.
export function nearestRow(times: readonly number[], time: number): number {
  const row = firstRowFrom(times, time);
  const isBefore = row > 0 && (row === times.length || time - times[row - 1] < times[row] - time);
  return isBefore ? row - 1 : row < times.length ? row : -1;
}

/// The value of the row whose time is nearest; NaN in a gap, unless the row is less than `reach` away.
export function valueNear(
  times: readonly number[],
  values: ArrayLike<number>,
  time: number,
  reach: number,
): number {
  const after = firstRowFrom(times, time);
  const row = nearestRow(times, time);
  if (row < 0) return NaN;
  const isBetween = Number.isFinite(values[after - 1]) && Number.isFinite(values[after]);
  return isBetween || Math.abs(times[row] - time) <= reach ? values[row] : NaN;
}

/// The top of an axis that stays in place: 1, 2 or 5 times a power of ten above `high`, kept from
/// `before` until the values need another one, or less than 0.4 of it.
export function steadyTop(high: number, before: number, least: number): number {
  const needed = Math.max(high * headroom, least);
  if (needed <= before && needed >= 0.4 * before) return before;
  const power = 10 ** Math.floor(Math.log10(needed));
  return [1, 2, 5].map((factor) => factor * power).find((top) => top >= needed) ?? 10 * power;
}

/// The rows [first, end) whose times are in a span, with one beyond each end; `times` ascend.
export function rowsInSpan(
  times: readonly number[],
  [from, to]: readonly [number, number],
): [number, number] {
  return [Math.max(0, firstRowFrom(times, from) - 1), firstRowFrom(times, to) + 1];
}

/// The first row whose time is not before `time`; the number of rows if all are before it.
function firstRowFrom(times: readonly number[], time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}
