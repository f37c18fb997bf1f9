// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type * as Plot from '@observablehq/plot';
import { create } from '../ui/dom';
import { saveText, svgText } from '../ui/plot_files';
import { aspectOf, drawChart, drawStrip } from './chart';
import { bandColors, laneColors, pinColor, seriesColors } from './colors';
import { drawLanes, wholeSpan } from './lane_chart';
import type { LaneData, PlotData, Series } from './report_data';
import { csvOfLanes, csvOfPlot } from './csv';
import { addSelection, type Area } from './selection';
import { type Range, viewOfArea, viewOfColumns, wholeView } from './view';

type Chart = Plot.Plot & SVGSVGElement;

/// A plot with caption and legend; dragging across it zooms in.
export function plotFigure(plot: PlotData): HTMLElement {
  const aspect = aspectOf(plot);
  const whole = wholeView(plot, aspect);
  const figure = zoomableFigure(
    plot.title,
    plotLegend(plot),
    () => drawChart(plot, whole),
    ({ x, y }) =>
      drawChart(plot, plot.equal_axes ? viewOfArea({ x, y }, aspect) : viewOfColumns(plot, x)),
    plot.equal_axes ?? false,
    () => csvOfPlot(plot),
  );
  if (plot.strip) figure.append(drawStrip(plot.strip, plot.strip_x_label ?? '', plot.title));
  figure.classList.toggle('map', plot.equal_axes ?? false);
  return figure;
}

/// Lanes over one x axis; dragging across them zooms in.
export function laneFigure(chart: LaneData): HTMLElement {
  const legend = chart.kind_labels.map((label, kind) => areaKey(laneColors[kind], label));
  const figure = zoomableFigure(
    chart.title,
    legend,
    () => drawLanes(chart, wholeSpan(chart)),
    ({ x }) => drawLanes(chart, x),
    false,
    () => csvOfLanes(chart),
  );
  figure.classList.add('wide');
  return figure;
}

function zoomableFigure(
  title: string,
  legend: HTMLElement[],
  drawWhole: () => Chart,
  drawPart: (area: { x: Range; y: Range }) => Chart,
  selectsArea: boolean,
  tableText: () => string,
): HTMLElement {
  let chart = drawWhole();
  const reset = create('button', { type: 'button', textContent: 'Show all', hidden: true });
  const save = create('button', { type: 'button', textContent: 'Save SVG' });
  const drawing = create('div', { className: 'drawing' }, chart);
  const show = (next: Chart, isPart: boolean) => {
    chart.replaceWith(next);
    chart = next;
    reset.hidden = !isPart;
  };
  const select = (area: Area) => show(drawPart(inUnits(chart, area)), true);
  addSelection(drawing, () => chart, select, selectsArea);
  const showAll = () => show(drawWhole(), false);
  drawing.addEventListener('dblclick', showAll);
  reset.addEventListener('click', showAll);
  save.addEventListener('click', () =>
    saveText(title, 'svg', 'image/svg+xml', svgText(chart, '#1c2126')),
  );
  const table = create('button', { type: 'button', textContent: 'Save CSV' });
  table.addEventListener('click', () => saveText(title, 'csv', 'text/csv', tableText()));
  return create(
    'figure',
    {},
    create('figcaption', {}, title, create('span', { className: 'actions' }, reset, save, table)),
    create('p', { className: 'legend' }, ...legend),
    drawing,
  );
}

function inUnits(chart: Chart, { x, y }: Area): { x: Range; y: Range } {
  const invert = (name: 'x' | 'y', [from, to]: Range): Range => {
    const scale = chart.scale(name);
    return [Number(scale?.invert?.(from) ?? 0), Number(scale?.invert?.(to) ?? 0)];
  };
  return { x: invert('x', x), y: invert('y', [y[1], y[0]]) }; // the y axis points up
}

function plotLegend(plot: PlotData): HTMLElement[] {
  const isUsed = (kind: number) => plot.bands.some((band) => band.kind === kind);
  const pins = [false, true].filter((hollow) => plot.pins.some((pin) => pin.hollow === hollow));
  return [
    ...plot.series.map(seriesKey),
    ...plot.band_labels.flatMap((label, kind) =>
      isUsed(kind) ? [areaKey(bandColors[kind], label)] : [],
    ),
    ...pins.map((hollow) => pinKey(hollow, hollow ? plot.hollow_pin_label : plot.pin_label)),
  ];
}

function seriesKey({ label, color, dashed, points }: Series): HTMLElement {
  const key = create('i', { className: points ? 'cross' : dashed ? 'dashed' : 'line' });
  if (points) key.textContent = '×';
  key.style.color = seriesColors[color];
  return create('span', {}, key, label);
}

function areaKey(color: string, label: string): HTMLElement {
  const key = create('i', { className: 'area' });
  key.style.background = color;
  return create('span', {}, key, label);
}

function pinKey(hollow: boolean, label: string): HTMLElement {
  const key = create('i', { textContent: hollow ? '▽' : '▼' });
  key.style.color = pinColor;
  return create('span', {}, key, label);
}
