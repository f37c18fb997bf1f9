// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { csvText } from '../ui/plot_files';
import type { LaneData, PlotData, TableData } from './report_data';

/// Two columns a series: each has its own x.
export function csvOfPlot({ series, x_label, y_label }: PlotData): string {
  const names = series.flatMap(({ label }) => [`${label}: ${x_label}`, `${label}: ${y_label}`]);
  const rows = Math.max(0, ...series.map(({ x }) => x.length));
  const columns = series.flatMap(({ x, y }) => [padded(x, rows), padded(y, rows)]);
  return csvText(names, columns);
}

function padded(values: readonly (number | null)[], rows: number): (number | null)[] {
  return [...values, ...Array<null>(rows - values.length).fill(null)];
}

/// A row for each interval.
export function csvOfLanes({ lanes, kind_labels }: LaneData): string {
  const rows = lanes.flatMap(({ group, label, intervals }) =>
    intervals.map(({ from, to, kind }) => [group, label, from, to, kind_labels[kind]].join(',')),
  );
  return ['group,lane,from,to,kind', ...rows, ''].join('\r\n');
}

/// A table as it is shown (RFC 4180).
export function csvOfTable({ columns, rows }: TableData): string {
  const quoted = (cell: string) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);
  return [...[columns, ...rows].map((cells) => cells.map(quoted).join(',')), ''].join('\r\n');
}
