// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { csvRow, csvText } from '../ui/plot_files';
import type { LaneData, PlotData, TableData } from './report_data';

/// Two columns a series: each has its own x.
export function csvOfPlot({ series, x_label, y_label }: PlotData): string {
  const rows = Math.max(0, ...series.map(({ x }) => x.length));
  return csvText(
    series.flatMap(({ label, x, y }) => [
      { name: `${label}: ${x_label}`, values: padded(x, rows) },
      { name: `${label}: ${y_label}`, values: padded(y, rows) },
    ]),
  );
}

function padded(values: readonly (number | null)[], rows: number): (number | null)[] {
  return [...values, ...Array<null>(rows - values.length).fill(null)];
}

/// A row for each interval.
export function csvOfLanes({ lanes, kind_labels }: LaneData): string {
  const rows = lanes.flatMap(({ group, label, intervals }) =>
    intervals.map(({ from, to, kind }) => csvRow([group, label, from, to, kind_labels[kind]])),
  );
  return ['group,lane,from,to,kind', ...rows, ''].join('\r\n');
}

/// A table as it is shown.
export function csvOfTable({ columns, rows }: TableData): string {
  return [...[columns, ...rows].map(csvRow), ''].join('\r\n');
}
