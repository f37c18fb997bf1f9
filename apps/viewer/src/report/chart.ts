// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import * as Plot from '@observablehq/plot';
import { bandOpacity, kindColors, pinColor, seriesColors, softInk } from './colors';
import { hatchClass, makeHatch } from '../hatch';
import { draw } from './drawing';
import { labelHeight, placeLabels, type PlacedLabel } from './mark_labels';
import type { Medium } from './medium';
import { number } from './number';
import type { Interval, PlotData, Series } from './report_data';
import { pointsOf, type ValueRow, valuesByX } from './values';
import type { View } from './view';

const fontSize = 12; // [SVG units]
const pinHeight = 11; // [SVG units] above the frame
const margins = { marginTop: 14, marginRight: 14, marginBottom: 40 }; // [SVG units]

/// The plot's inner width over its inner height.
export function aspectOf(plot: PlotData, medium: Medium): number {
  return innerWidth(medium) / innerHeight(plot, medium);
}

function innerHeight(plot: PlotData, medium: Medium): number {
  return heightOf(plot, medium) - margins.marginTop - margins.marginBottom;
}

function innerWidth({ width, left }: Medium): number {
  return width - left - margins.marginRight;
}

/// Draws the part of a plot that is in the view; labels of marks are above it, off the curves.
export function drawChart(plot: PlotData, view: View, medium: Medium): Plot.Plot & SVGSVGElement {
  const marks = plot.marks.filter((mark) => isIn(view, mark.x));
  const [from, to] = view.x;
  const labels = placeLabels(marks, innerWidth(medium) / (to - from), medium.markRows, to);
  const labelRows = Math.max(0, ...labels.map(({ row }) => row + 1));
  return draw({
    width: medium.width,
    height: heightOf(plot, medium) + labelRows * labelHeight,
    ...margins,
    marginTop: margins.marginTop + labelRows * labelHeight,
    marginLeft: medium.left,
    ariaLabel: plot.title,
    style: { fontSize: `${fontSize}px` },
    x: { domain: view.x },
    y: { domain: view.y },
    marks: [
      Plot.rect(plot.bands, {
        x1: 'from',
        x2: (band) => Math.min(band.to, view.x[1]),
        fill: (band) => kindColors[band.kind],
        fillOpacity: bandOpacity,
        insetRight: -1, // a band of a single frame is visible
        clip: true,
      }),
      ...drawHatch(plot, view),
      ...drawAxes(plot, view, medium),
      ...plot.series.map(drawSeries),
      Plot.ruleX(marks, { x: 'x', stroke: softInk, strokeDasharray: '2 3' }),
      ...drawLabels(labels, labelRows),
      ...drawPins(plot, view),
      Plot.frame({ stroke: softInk }),
      drawTip(plot, view),
    ],
  });
}

/// A low chart of one line over its own axis.
export function drawStrip(
  strip: Series,
  xLabel: string,
  title: string,
  { width, stripHeight, left }: Medium,
): SVGSVGElement {
  const points = pointsOf(strip);
  const axis = { tickSize: 0, labelAnchor: 'center' as const, labelArrow: 'none' as const };
  const ticks = Math.floor((stripHeight - margins.marginTop - margins.marginBottom) / 20);
  return draw({
    width,
    height: stripHeight,
    ...margins,
    marginLeft: left,
    ariaLabel: `${title}: ${strip.label}`,
    style: { fontSize: `${fontSize}px` },
    y: { zero: true },
    marks: [
      Plot.axisX({ ...axis, label: xLabel }),
      // Above the axis: beside it there is less room than the label is long.
      Plot.axisY({ ...axis, label: strip.label, labelAnchor: 'top', ticks }),
      Plot.lineY(points, { x: 'x', y: 'y', stroke: seriesColors[strip.color] }),
      Plot.frame({ stroke: softInk }),
    ],
  });
}

function drawAxes(plot: PlotData, view: View, medium: Medium): Plot.Markish[] {
  const { left } = medium;
  const axis = {
    tickSize: 0,
    labelAnchor: 'center' as const,
    labelArrow: 'none' as const,
    ...(plot.equal_axes ? { tickSpacing: 80 } : {}), // the same ticks on both axes of a map
  };
  const { tickSpacing } = axis;
  return [
    Plot.gridX({ strokeOpacity: 0.15, tickSpacing }),
    Plot.gridY({ strokeOpacity: 0.15, tickSpacing }),
    Plot.axisX({ ...axis, label: plot.x_label }),
    Plot.axisY({ ...axis, label: null, tickFormat: tickFormat(view.y) }),
    // Beside the longest numbers.
    Plot.axisY({
      ...axis,
      ticks: [],
      label: plot.y_label,
      labelOffset: left - 6,
      fontSize: fittingSize(plot.y_label, innerHeight(plot, medium)),
    }),
  ];
}

const meanCharacter = 0.55; // of the font's size

/// The font's size at which a label is no longer than this.
function fittingSize(label: string, length: number): number {
  return Math.min(fontSize, length / (meanCharacter * label.length));
}

const plainTick = new Intl.NumberFormat('en', { maximumSignificantDigits: 6 });
const shortTick = new Intl.NumberFormat('en', {
  notation: 'compact',
  maximumSignificantDigits: 4,
});

/// All ticks of an axis alike.
function tickFormat(range: readonly number[]): (value: number) => string {
  const isLong = range.some((end) => Math.abs(end) >= 1e4);
  const format = isLong ? shortTick : plainTick;
  return (value) => format.format(value).replace('-', '−');
}

function heightOf(plot: PlotData, { height, mapHeight, stripHeight }: Medium): number {
  if (!plot.equal_axes) return height;
  return plot.strip ? mapHeight - stripHeight : mapHeight;
}

function drawSeries({ x, y, color, dashed, points }: Series): Plot.Markish {
  const stroke = seriesColors[color];
  if (points) return Plot.dot(x, { x, y, stroke, symbol: 'times', r: 3, clip: true });
  const strokeDasharray = dashed ? '6 5' : undefined;
  return Plot.line(x, { x, y, stroke, strokeDasharray, strokeWidth: 1.6, clip: true });
}

/// Over the bands of one kind.
function drawHatch(plot: PlotData, view: View): Plot.Markish[] {
  const bands = plot.bands.filter(({ kind }) => hatchClass(kindColors[kind]) !== '');
  if (bands.length === 0) return [];
  const { definition, fill } = makeHatch();
  const to = (band: Interval) => Math.min(band.to, view.x[1]);
  const hatched = { x1: 'from', x2: to, fill, fillOpacity: bandOpacity, clip: true };
  return [() => definition, Plot.rect(bands, hatched)];
}

/// Above the frame and the pins at its edge, the first row highest.
function drawLabels(labels: readonly PlacedLabel[], rows: number): Plot.Markish[] {
  return Array.from({ length: rows }, (_, row) =>
    (['right', 'left'] as const).map((side) =>
      Plot.text(
        labels.filter((label) => label.row === row && label.side === side),
        {
          x: 'x',
          text: 'text',
          frameAnchor: 'top-left',
          textAnchor: side === 'right' ? 'start' : 'end',
          dx: side === 'right' ? -2 : 2,
          dy: -pinHeight - (rows - row) * labelHeight,
        },
      ),
    ),
  ).flat();
}

function drawPins(plot: PlotData, view: View): Plot.Markish[] {
  return [false, true].map((hollow) =>
    Plot.dot(
      plot.pins.filter((pin) => pin.hollow === hollow && isIn(view, pin.x)),
      {
        x: 'x',
        frameAnchor: 'top',
        dy: -6,
        symbol: 'triangle',
        rotate: 180,
        r: 3.5,
        stroke: pinColor,
        fill: hollow ? 'none' : pinColor,
      },
    ),
  );
}

/// The values at the pointer: of all curves at its x, or of the nearest point of a map or of marks.
function drawTip(plot: PlotData, view: View): Plot.Markish {
  if (plot.equal_axes || plot.series.some(({ points }) => points)) return drawPointTip(plot, view);
  const rows = valuesByX(plot.series).filter(
    ({ x, y }) => isIn(view, x) && y >= view.y[0] && y <= view.y[1],
  );
  const title = ({ x, values }: ValueRow) =>
    [`${plot.x_label}: ${number(x)}`, `${plot.y_label}:`, ...values].join('\n');
  return Plot.tip(rows, Plot.pointerX({ x: 'x', y: 'y', title }));
}

function drawPointTip(plot: PlotData, view: View): Plot.Markish {
  const points = plot.series.flatMap((one) =>
    pointsOf(one).map((at) => ({ ...at, label: one.label })),
  );
  const shown = points.filter(({ x, y }) => isIn(view, x) && y >= view.y[0] && y <= view.y[1]);
  return Plot.tip(
    shown,
    Plot.pointer({
      x: 'x',
      y: 'y',
      title: ({ label, x, y }) =>
        `${label}\n${plot.x_label}: ${number(x)}\n${plot.y_label}: ${number(y)}`,
    }),
  );
}

function isIn(view: View, x: number): boolean {
  return x >= view.x[0] && x <= view.x[1];
}
