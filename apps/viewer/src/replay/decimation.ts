// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Which rows to draw of many: of each of `buckets` runs of rows its least and its greatest value of
/// each column, and the first that is none (NaN), in order. A peak of one row stays a peak, and an
/// interruption one.
export function decimate(columns: readonly Float64Array[], buckets: number): number[] {
  const rows = columns[0]?.length ?? 0;
  if (rows <= 2 * columns.length * buckets) return Array.from({ length: rows }, (_, i) => i);
  const kept = new Set<number>([0, rows - 1]);
  for (let bucket = 0; bucket < buckets; ++bucket) {
    const from = Math.floor((bucket * rows) / buckets);
    const to = Math.floor(((bucket + 1) * rows) / buckets);
    for (const column of columns) {
      let [least, most, none] = [-1, -1, -1];
      for (let row = from; row < to; ++row) {
        if (Number.isNaN(column[row])) {
          if (none < 0) none = row;
        } else {
          if (least < 0 || column[row] < column[least]) least = row;
          if (most < 0 || column[row] > column[most]) most = row;
        }
      }
      for (const row of [least, most, none]) if (row >= 0) kept.add(row);
    }
  }
  return [...kept].sort((a, b) => a - b);
}
