// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type * as Plot from '@observablehq/plot';
import { hatchClass } from '../hatch';
import { create } from '../ui/dom';
import { saveText, svgText } from '../ui/plot_files';
import { aspectOf, drawChart, drawStrip } from './chart';
import { bandOpacity, kindColors, pinColor, seriesColors } from './colors';
import { drawLanes, wholeSpan } from './lane_chart';
import { type Medium, onPrint, screen } from './medium';
import type { LaneData, PlotData, Series } from './report_data';
import { csvOfLanes, csvOfPlot } from './csv';
import { addSelection, type Area } from './selection';
import { type Range, type View, viewOfArea, viewOfColumns, wholeView } from './view';

type Chart = Plot.Plot & SVGSVGElement;

/// A plot with caption and legend; dragging across it zooms in.
export function plotFigure(plot: PlotData): HTMLElement {
  const viewOf = (area: Area | null, medium: Medium): View => {
    const aspect = aspectOf(plot, medium);
    if (!area) return wholeView(plot, aspect);
    return plot.equal_axes ? viewOfArea(area, aspect) : viewOfColumns(plot, area.x);
  };
  const figure = zoomableFigure(
    plot.title,
    plotLegend(plot),
    (area, medium) => drawChart(plot, viewOf(area, medium), medium),
    plot.equal_axes ?? false,
    () => csvOfPlot(plot),
  );
  if (plot.strip) figure.append(stripOf(plot, plot.strip));
  figure.classList.toggle('map', plot.equal_axes ?? false);
  return figure;
}

function stripOf({ title, strip_x_label: xLabel = '' }: PlotData, strip: Series): SVGSVGElement {
  let shown = drawStrip(strip, xLabel, title, screen);
  const first = shown;
  onPrint((medium) => {
    const next = drawStrip(strip, xLabel, title, medium);
    shown.replaceWith(next);
    shown = next;
  });
  return first;
}

/// Lanes over one x axis; dragging across them zooms in.
export function laneFigure(chart: LaneData): HTMLElement {
  const legend = chart.kind_labels.map((label, kind) => areaKey(kindColors[kind], label));
  const figure = zoomableFigure(
    chart.title,
    legend,
    (area, medium) => drawLanes(chart, area?.x ?? wholeSpan(chart), medium),
    false,
    () => csvOfLanes(chart),
  );
  figure.classList.add('wide');
  return figure;
}

/// `draw`: the part in an area (in the axes' units), or all.
function zoomableFigure(
  title: string,
  legend: HTMLElement[],
  draw: (area: Area | null, medium: Medium) => Chart,
  selectsArea: boolean,
  tableText: () => string,
): HTMLElement {
  let shown: Area | null = null;
  let chart = draw(shown, screen);
  const reset = create('button', { type: 'button', textContent: 'Show all', hidden: true });
  const save = create('button', { type: 'button', textContent: 'Save SVG' });
  const drawing = create('div', { className: 'drawing' }, chart);
  const redraw = (medium: Medium) => {
    const next = draw(shown, medium);
    chart.replaceWith(next);
    chart = next;
  };
  const show = (area: Area | null) => {
    shown = area;
    redraw(screen);
    reset.hidden = area === null;
  };
  onPrint(redraw);
  addSelection(
    drawing,
    () => chart,
    (area) => show(inUnits(chart, area)),
    selectsArea,
  );
  drawing.addEventListener('dblclick', () => show(null));
  reset.addEventListener('click', () => show(null));
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

function inUnits(chart: Chart, { x, y }: Area): Area {
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
      isUsed(kind) ? [areaKey(kindColors[kind], label, bandOpacity)] : [],
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

function areaKey(color: string, label: string, opacity = 1): HTMLElement {
  const key = create('i', { className: 'area' });
  key.style.setProperty('--area', color);
  key.classList.toggle('critical', hatchClass(color) !== '');
  key.style.opacity = String(opacity);
  return create('span', {}, key, label);
}

function pinKey(hollow: boolean, label: string): HTMLElement {
  const key = create('i', { textContent: hollow ? '▽' : '▼' });
  key.style.color = pinColor;
  return create('span', {}, key, label);
}
