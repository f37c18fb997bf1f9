// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

import { typeset } from './typeset';

// A report's content, as the C++ module `report` writes it.

export interface Series {
  label: string;
  color: number; // index into seriesColors
  dashed?: boolean;
  points?: boolean; // marks instead of a line
  x: (number | null)[];
  y: (number | null)[]; // null breaks the line
}

export interface Interval {
  from: number;
  to: number;
  kind: number;
}

export interface PlotData {
  title: string;
  x_label: string;
  y_label: string;
  series: Series[];
  bands: Interval[];
  band_labels: string[]; // by kind
  marks: { x: number; label: string }[];
  pins: { x: number; hollow: boolean }[];
  pin_label: string;
  hollow_pin_label: string;
  strip?: Series; // below the plot; its label is that of its y axis
  strip_x_label?: string;
  from_zero?: boolean; // both axes
  y_from_zero?: boolean;
  equal_axes?: boolean; // a map
  x_from?: number;
  x_to?: number;
  y_to?: number;
}

export interface LaneData {
  title: string;
  x_label: string;
  kind_labels: string[];
  lanes: { group: string; label: string; intervals: Interval[] }[];
}

export interface TableData {
  title: string;
  columns: string[];
  rows: string[][];
  note: string;
  folded: boolean;
}

export type Block =
  | { kind: 'text'; text: string; highlighted: boolean }
  | { kind: 'picture'; title: string; source: string; note: string }
  | { kind: 'plots'; title: string; plots: PlotData[] }
  | ({ kind: 'lanes' } & LaneData)
  | { kind: 'tables'; tables: TableData[] };

export interface ReportData {
  format: string;
  title: string;
  heading: string;
  inputs: { text: string; strong: boolean }[][];
  notes: string[];
  verdict: string;
  headline: TableData; // the most important first
  sections: { title: string; blocks: Block[] }[];
  footer: string;
  command?: string; // that made the report
}

const format = 'pcavr-report-data/1';

/// Throws if the text is not a report of this format.
export function readReport(text: string): ReportData {
  const report = JSON.parse(text, (_, value: unknown) =>
    typeof value === 'string' ? typeset(value) : value,
  ) as ReportData;
  if (report.format !== format) throw new Error(`${report.format} is not ${format}`);
  return report;
}
