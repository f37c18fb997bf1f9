// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

const headroom = 1.08;

/// An axis' range: with zero, at least up to `minSpan`.
export function axisRange(
  columns: readonly ArrayLike<number>[],
  minSpan: number,
): [number, number] {
  const [low, high] = extent(columns);
  return [Math.min(0, low), Math.max(minSpan, high * headroom)];
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

function extent(columns: readonly ArrayLike<number>[]): [number, number] {
  let [low, high] = [0, 0];
  for (const column of columns) {
    for (let i = 0; i < column.length; ++i) {
      if (column[i] < low) low = column[i];
      if (column[i] > high) high = column[i];
    }
  }
  return [low, high];
}
