// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { CsvTable } from './plot_files';

export type PlotColumn = readonly number[] | Float64Array;

export type Span = readonly [number, number]; // [s]

export interface PlotSeries {
  title: string;
  color: string;
  isRight?: boolean; // of the second axis, on the right
  isComponent?: boolean; // of a vector: drawn only while components are shown
}

/// A bar in a lane below the curves.
export interface PlotBand {
  from: number; // [s]
  to: number; // [s]
  lane: number; // 0: the uppermost
  color: string;
}

/// A value that the curves are compared with: a horizontal line.
export interface PlotLimit {
  value: number; // on the left axis
  title: string;
}

/// What changes with what is plotted.
export interface PlotFrame {
  title: string;
  bands: readonly PlotBand[];
  limits: readonly PlotLimit[];
  marks: readonly number[]; // [s] dashed vertical lines
  minSpan: number; // of the left axis: noise about zero is not scaled up to fill the plot
}

export interface PlotOptions {
  title: string;
  note?: string; // legend of marks
  lanes?: readonly string[]; // names of the lanes below the curves
  bandKeys?: readonly PlotSeries[]; // legend of the bands' colours
  unit: string;
  rightUnit?: string;
  series: PlotSeries[];
  minSpan: number;
  onSeek?: (time: number) => void;
  table: () => CsvTable; // all rows, for CSV
}
