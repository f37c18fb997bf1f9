// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Which rows to draw of many: of each of `buckets` runs of rows its least and its greatest value of
/// each column, in order. A peak of one row stays a peak.
export function decimate(columns: readonly Float64Array[], buckets: number): number[] {
  const rows = columns[0]?.length ?? 0;
  if (rows <= 2 * columns.length * buckets) return Array.from({ length: rows }, (_, i) => i);
  const kept = new Set<number>([0, rows - 1]);
  for (let bucket = 0; bucket < buckets; ++bucket) {
    const from = Math.floor((bucket * rows) / buckets);
    const to = Math.floor(((bucket + 1) * rows) / buckets);
    for (const column of columns) {
      let [least, most] = [from, from];
      for (let row = from; row < to; ++row) {
        if (column[row] < column[least]) least = row;
        if (column[row] > column[most]) most = row;
      }
      kept.add(least).add(most);
    }
  }
  return [...kept].sort((a, b) => a - b);
}
