// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from './dom';
import { axisRange, nearestRow, rightPerLeft } from './plot_axes';
import { PlotDrawing } from './plot_drawing';
import { csvText, saveText, svgText } from './plot_files';

export type PlotColumn = readonly number[] | Float64Array;

export interface PlotSeries {
  title: string;
  color: string;
  isRight?: boolean; // of the second axis, on the right
}

/// A bar above the curves.
export interface PlotBand {
  from: number; // [s]
  to: number; // [s]
  row: number; // 0: the uppermost
  color: string;
}

/// A value that the curves are compared with: a horizontal line.
export interface PlotLimit {
  value: number; // on the left axis
  title: string;
}

export interface PlotOptions {
  title: string;
  note?: string; // legend of marks, and of the bands' rows
  bandKeys?: readonly PlotSeries[]; // legend of the bands' colours
  save?: () => { times: readonly number[]; columns: readonly PlotColumn[] }; // all rows, for CSV
  unit: string;
  rightUnit?: string;
  series: PlotSeries[];
  height: number; // [CSS pixels]
  onSeek?: (time: number) => void;
  bands?: readonly PlotBand[];
  marks?: readonly number[]; // [s] dashed vertical lines
  minSpan: number; // of the left axis: noise about zero is not scaled up to fill the plot
}

// [CSS pixels]
const axisWidth = 46;
// The same for every plot, with and without a right axis: times are below one another.
const margins = { top: 16, right: axisWidth, bottom: 24, left: axisWidth };
const bandHeight = 5;
const minDrag = 5; // less is a click

type Span = [number, number]; // [s]

/// A plot over time [s], in the page's colours and as wide as its container.
export class TimePlot {
  private static readonly all = new Set<TimePlot>();

  readonly element = create('div', { className: 'plot' });
  private times: readonly number[] = [];
  private columns: readonly PlotColumn[] = [];
  private whole: Span = [0, 1]; // [s]
  private zoomed: Span | null = null; // [s]
  private bandList: readonly PlotBand[];
  private limits: readonly PlotLimit[] = [];
  private minSpan: number;
  private drawing: Element = create('div');
  private readonly over = create('div', { className: 'over' }); // the area inside the axes
  private readonly playhead = create('div', { className: 'playhead', hidden: true });
  private readonly pointed = create('div', { className: 'pointed', hidden: true });
  private readonly selection = create('div', { className: 'selection', hidden: true });
  private readonly readout = create('div', { className: 'readout', hidden: true });
  private playheadTime = NaN; // [s]
  private readonly observer = new ResizeObserver(() => this.draw());

  constructor(
    parent: HTMLElement,
    private readonly options: PlotOptions,
  ) {
    this.bandList = options.bands ?? [];
    this.minSpan = options.minSpan;
    this.over.title = options.onSeek
      ? 'Click: go there. Drag: zoom in. Double-click: show all.'
      : 'Drag: zoom in. Double-click: show all.';
    this.over.append(this.pointed, this.playhead, this.selection, this.readout);
    Object.assign(this.over.style, {
      inset: `auto ${margins.right}px ${margins.bottom}px ${margins.left}px`,
      height: `${options.height - margins.top - margins.bottom}px`,
    });
    this.element.append(this.heading(), this.drawing, this.over);
    parent.append(this.element);
    this.addPointer();
    this.observer.observe(this.element);
    TimePlot.all.add(this);
  }

  /// A NaN interrupts its curve.
  setData(
    times: readonly number[],
    columns: readonly PlotColumn[],
    from: number,
    to: number,
  ): void {
    this.times = times;
    this.columns = columns;
    this.whole = [from, to];
    this.draw();
  }

  /// Before the next data: bands and limits that change, and the least span of the left axis.
  setFrame(bands: readonly PlotBand[], limits: readonly PlotLimit[], minSpan: number): void {
    this.bandList = bands;
    this.limits = limits;
    this.minSpan = minSpan;
  }

  get isZoomed(): boolean {
    return this.zoomed !== null;
  }

  /// Shows a part of the time; null: all of it.
  zoom(span: Span | null): void {
    this.zoomed = span;
    this.draw();
    this.setPlayhead(this.playheadTime);
  }

  setPlayhead(time: number): void {
    this.playheadTime = time;
    this.place(this.playhead, time);
  }

  remove(): void {
    TimePlot.all.delete(this);
    this.observer.disconnect();
    this.element.remove();
  }

  private heading(): HTMLElement {
    const { title, note, series, bandKeys = [] } = this.options;
    const keyOf = (className: string) => (entry: PlotSeries) => {
      const key = create('span', { className, textContent: entry.title });
      key.style.setProperty('--key', entry.color);
      return key;
    };
    const keys = [...series.map(keyOf('key')), ...bandKeys.map(keyOf('key area'))];
    const save = (textContent: string, what: string, action: () => void) => {
      const button = create('button', { type: 'button', textContent, title: what });
      button.addEventListener('click', action);
      return button;
    };
    const actions = create(
      'span',
      { className: 'actions' },
      save('SVG', 'Saves the plot as a drawing.', () => this.saveDrawing()),
      save('CSV', 'Saves the plotted numbers as a table.', () => this.saveTable()),
    );
    const notes = note
      ? [create('span', { className: 'note', textContent: note, title: note })]
      : [];
    return create('h3', {}, create('span', { textContent: title }), ...keys, ...notes, actions);
  }

  private saveDrawing(): void {
    const color = getComputedStyle(this.element).color;
    saveText(this.options.title, 'svg', 'image/svg+xml', svgText(this.drawing, color));
  }

  private saveTable(): void {
    const { series, save, title } = this.options;
    const { times, columns } = save?.() ?? { times: this.times, columns: this.columns };
    const names = series.map((entry) => `${entry.title} (${this.unitOf(entry)})`);
    saveText(title, 'csv', 'text/csv', csvText(['time (s)', ...names], [times, ...columns]));
  }

  private unitOf(series: PlotSeries): string {
    const { unit, rightUnit = unit } = this.options;
    return series.isRight ? rightUnit : unit;
  }

  private get span(): Span {
    return this.zoomed ?? this.whole;
  }

  private draw(): void {
    const { options, minSpan } = this;
    const limits = this.limits.map(({ value }) => value);
    const left = [...this.select(false), limits];
    const scale = rightPerLeft(left, this.select(true), minSpan);
    const columns = this.columns.map((column, i) =>
      options.series[i].isRight ? Array.from(column, (value) => value / scale) : column,
    );
    const frame = {
      width: this.element.clientWidth || 300,
      height: options.height,
      margins,
      x: this.span,
      y: axisRange([...columns, limits], minSpan),
    };
    const drawing = new PlotDrawing(frame, options.title);
    drawing.axes(options.unit, options.rightUnit, scale);
    options.marks?.forEach((time) => drawing.mark(time));
    columns.forEach((column, i) => drawing.curve(this.times, column, options.series[i].color));
    for (const { from, to, row, color } of this.bandList)
      drawing.band(from, to, row * (bandHeight + 1), bandHeight, color);
    for (const { value, title } of this.limits) drawing.limit(value, title);
    this.drawing.replaceWith(drawing.svg);
    this.drawing = drawing.svg;
  }

  private select(isRight: boolean): PlotColumn[] {
    return this.columns.filter((_, i) => (this.options.series[i].isRight ?? false) === isRight);
  }

  private place(line: HTMLElement, time: number): void {
    const share = (time - this.span[0]) / (this.span[1] - this.span[0]);
    line.hidden = !(share >= 0 && share <= 1);
    if (!line.hidden) line.style.left = `${(100 * share).toFixed(2)}%`;
  }

  /// The time under the pointer is marked in all plots, with its values. A click goes there, a drag
  /// zooms all plots, a double click shows all.
  private addPointer(): void {
    const { over, selection } = this;
    let pressed: number | null = null; // [CSS pixels]
    const xOf = (event: PointerEvent) => {
      const { left, width } = over.getBoundingClientRect();
      return Math.min(Math.max(event.clientX - left, 0), width);
    };
    const timeAt = (x: number) =>
      this.span[0] + (x / over.clientWidth) * (this.span[1] - this.span[0]);
    over.addEventListener('pointermove', (event) => {
      const x = xOf(event);
      for (const plot of TimePlot.all) plot.point(timeAt(x));
      selection.hidden = pressed === null || Math.abs(x - pressed) < minDrag;
      if (pressed === null) return;
      selection.style.left = `${Math.min(x, pressed)}px`;
      selection.style.width = `${Math.abs(x - pressed)}px`;
    });
    over.addEventListener('pointerleave', () => {
      for (const plot of TimePlot.all) plot.point(NaN);
    });
    over.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      pressed = xOf(event);
    });
    over.addEventListener('pointerup', (event) => {
      const [x, from] = [xOf(event), pressed];
      pressed = null;
      selection.hidden = true;
      if (from === null) return;
      if (Math.abs(x - from) < minDrag) return this.options.onSeek?.(timeAt(x));
      const span: Span = [timeAt(Math.min(x, from)), timeAt(Math.max(x, from))];
      for (const plot of TimePlot.all) plot.zoom(span);
    });
    over.addEventListener('pointercancel', () => {
      pressed = null;
      selection.hidden = true;
    });
    over.addEventListener('dblclick', () => {
      for (const plot of TimePlot.all) plot.zoom(null);
    });
  }

  /// Marks a time, and shows its values; NaN: none.
  private point(time: number): void {
    this.place(this.pointed, time);
    this.readout.hidden = this.pointed.hidden;
    if (this.readout.hidden) return;
    const row = nearestRow(this.times, time);
    const lines = this.options.series.map((entry, i) => {
      const value = this.columns[i]?.[row] ?? NaN;
      const text = Number.isFinite(value) ? `${value.toFixed(2)} ${this.unitOf(entry)}` : '–';
      return create('div', {}, `${entry.title}: ${text}`);
    });
    this.readout.replaceChildren(create('div', {}, `${time.toFixed(2)} s`), ...lines);
    const share = parseFloat(this.pointed.style.left);
    this.readout.style.left = `${share}%`;
    this.readout.classList.toggle('left', share > 60);
  }
}
