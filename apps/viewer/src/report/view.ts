// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { PlotData } from './report_data';

export type Range = [number, number];

/// What a plot shows, in its axes' units.
export interface View {
  x: Range;
  y: Range;
}

const minSpan = 0.01; // of either axis: 0.01 mm of error, 10 mm of a path
const headroom = 0.06; // of the y axis, above the maximum
const mapMargin = 1.1; // of a map, around the path

/// The whole plot. `aspect`: width over height, for equal scales of a map's axes.
export function wholeView(plot: PlotData, aspect: number): View {
  const x = rangeOf(plot.series.map((series) => series.x));
  if (plot.from_zero) include(x, 0);
  if (plot.x_from !== undefined) x[0] = plot.x_from;
  if (plot.x_to !== undefined) x[1] = plot.x_to;
  const shown = widened(x);
  const y = rangeOfY(plot);
  return plot.equal_axes
    ? withEqualScales({ x: shown, y: widened(y) }, mapMargin, aspect)
    : { x: shown, y: withHeadroom(y, plot) };
}

/// Part of the x axis, with the y axis scaled to the values in it.
export function viewOfColumns(plot: PlotData, x: Range): View {
  return { x, y: withHeadroom(rangeOfY(plot, x), plot) };
}

/// Part of a map.
export function viewOfArea(area: View, aspect: number): View {
  return withEqualScales(area, 1, aspect);
}

function rangeOfY(plot: PlotData, [from, to]: Range = [-Infinity, Infinity]): Range {
  const y = rangeOf(
    plot.series.map((series) =>
      series.y.filter((_, i) => {
        const x = series.x[i];
        return x !== null && x >= from && x <= to;
      }),
    ),
  );
  if (plot.from_zero || plot.y_from_zero) include(y, 0);
  return y;
}

function withHeadroom(values: Range, plot: PlotData): Range {
  const y = widened(plot.y_to === undefined ? values : [values[0], plot.y_to]);
  return plot.y_to === undefined ? [y[0], y[1] + headroom * (y[1] - y[0])] : y;
}

function rangeOf(columns: (number | null)[][]): Range {
  const range: Range = [Infinity, -Infinity];
  for (const column of columns) for (const value of column) include(range, value);
  return range;
}

function include(range: Range, value: number | null): void {
  if (value === null) return;
  range[0] = Math.min(range[0], value);
  range[1] = Math.max(range[1], value);
}

function widened([low, high]: Range): Range {
  if (!(low <= high)) return [0, minSpan];
  return [low, Math.max(high, low + minSpan)];
}

function withEqualScales({ x, y }: View, margin: number, aspect: number): View {
  const height = margin * Math.max((x[1] - x[0]) / aspect, y[1] - y[0]);
  return { x: centred(x, height * aspect), y: centred(y, height) };
}

function centred([low, high]: Range, span: number): Range {
  const centre = (low + high) / 2;
  return [centre - span / 2, centre + span / 2];
}
