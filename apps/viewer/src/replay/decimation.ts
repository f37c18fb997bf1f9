// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Min-max decimation for plots: of each of `buckets` intervals of rows, the rows of each column's
/// minimum, maximum and first NaN, ascending. A peak or a gap of a single row survives.
export function decimate(columns: readonly Float64Array[], buckets: number): number[] {
  const rows = columns[0]?.length ?? 0;
  if (rows <= 2 * columns.length * buckets) return Array.from({ length: rows }, (_, i) => i);
  const kept = new Set<number>([0, rows - 1]);
  for (let bucket = 0; bucket < buckets; ++bucket) {
    const from = Math.floor((bucket * rows) / buckets);
    const to = Math.floor(((bucket + 1) * rows) / buckets);
    for (const column of columns) {
      let [min, max, gap] = [-1, -1, -1];
      for (let row = from; row < to; ++row) {
        if (Number.isNaN(column[row])) {
          if (gap < 0) gap = row;
        } else {
          if (min < 0 || column[row] < column[min]) min = row;
          if (max < 0 || column[row] > column[max]) max = row;
        }
      }
      for (const row of [min, max, gap]) if (row >= 0) kept.add(row);
    }
  }
  return [...kept].sort((a, b) => a - b);
}
