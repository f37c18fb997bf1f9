// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from './dom';
import { significant } from './format';
import { axisRange, headroom, rightPerLeft, rowsInSpan, valueNear } from './plot_axes';
import { PlotDrawing } from './plot_drawing';
import { csvText, saveText, svgText } from './plot_files';
import { PlotHeading } from './plot_heading';
import type { PlotColumn, PlotFrame, PlotOptions, PlotSeries, Span } from './plot_options';
import { PlotPointer } from './plot_pointer';
import { spikesOutside } from './plot_spikes';

// [CSS pixels]
const axisWidth = 56;
// The same for every plot, with and without a right axis: times are below one another.
const margins = { top: 16, right: axisWidth, bottom: 24, left: axisWidth };

const pointerReach = 0.01; // of the time axis: what is nearer is at the pointer

/// A plot over time [s], in the page's colours and as wide as its container. All plots of the page
/// show the same span of time, point at the same time, and have the same height.
export class TimePlot {
  private static readonly all = new Set<TimePlot>();
  private static height = 200; // [CSS pixels]
  private static pointed: number | null = null; // share of the time axis at the pointer
  private static zoomed: Span | null = null; // [s]

  readonly element = create('div', { className: 'plot' });
  private times: readonly number[] = [];
  private columns: readonly PlotColumn[] = [];
  private whole: Span = [0, 1]; // [s]
  private frame: PlotFrame;
  private showsComponents = false;
  private drawing: Element = create('div');
  private readonly heading: PlotHeading;
  private readonly over = create('div', { className: 'over' }); // the area inside the axes
  private readonly playhead = create('div', { className: 'playhead', hidden: true });
  private readonly pointed = create('div', { className: 'pointed', hidden: true });
  private readonly readout = create('div', { className: 'readout', hidden: true });
  private playheadTime = NaN; // [s]

  constructor(
    parent: HTMLElement,
    private readonly options: PlotOptions,
  ) {
    const { title, minSpan, onSeek } = options;
    this.frame = { title, minSpan, bands: [], limits: [], marks: [] };
    const zooming = 'Drag: zoom in. Double-click: show all.';
    this.over.title = onSeek ? `Click: go there. ${zooming}` : zooming;
    this.over.append(this.pointed, this.playhead, this.readout);
    this.heading = new PlotHeading(options, {
      showComponents: (areShown) => {
        this.showsComponents = areShown;
        this.draw();
      },
      showAll: () => TimePlot.zoom(null),
      saveDrawing: () => this.saveDrawing(),
      saveTable: () => saveText(this.frame.title, 'csv', 'text/csv', csvText(options.table())),
    });
    this.element.append(this.heading.element, this.drawing, this.over);
    parent.append(this.element);
    new PlotPointer(this.over, {
      point: (share) => TimePlot.point(share),
      seek: (share) => onSeek?.(this.timeAt(share)),
      zoom: (from, to) => TimePlot.zoom([this.timeAt(from), this.timeAt(to)]),
      showAll: () => TimePlot.zoom(null),
    });
    new ResizeObserver(() => this.draw()).observe(this.element);
    TimePlot.all.add(this);
  }

  /// [CSS pixels] of all plots, without their headings.
  static setHeight(height: number): void {
    TimePlot.height = height;
    for (const plot of TimePlot.all) plot.draw();
  }

  static get isZoomed(): boolean {
    return TimePlot.zoomed !== null;
  }

  /// All plots show a part of the time; null: all of it.
  private static zoom(span: Span | null): void {
    TimePlot.zoomed = span;
    for (const plot of TimePlot.all) plot.draw();
  }

  private static point(share: number | null): void {
    TimePlot.pointed = share;
    for (const plot of TimePlot.all) plot.showPointed();
  }

  /// Before the next data: what changes with what is plotted.
  setFrame(frame: Partial<PlotFrame>): void {
    this.frame = { ...this.frame, ...frame };
    this.heading.setTitle(this.frame.title);
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

  setPlayhead(time: number): void {
    this.playheadTime = time;
    const [from, to] = this.span;
    placeAt(this.playhead, (time - from) / (to - from));
  }

  private saveDrawing(): void {
    const color = getComputedStyle(this.element).color;
    saveText(this.frame.title, 'svg', 'image/svg+xml', svgText(this.drawing, color));
  }

  private unitOf(series: PlotSeries): string {
    const { unit, rightUnit = unit } = this.options;
    return series.isRight ? rightUnit : unit;
  }

  private get span(): Span {
    return TimePlot.zoomed ?? this.whole;
  }

  private timeAt(share: number): number {
    const [from, to] = this.span;
    return from + share * (to - from);
  }

  /// The series that are drawn, with their columns.
  private get shown(): { series: PlotSeries; column: PlotColumn }[] {
    return this.options.series.flatMap((series, i) => {
      const column = this.columns[i];
      return column && (this.showsComponents || !series.isComponent) ? [{ series, column }] : [];
    });
  }

  private draw(): void {
    const { options, frame, shown } = this;
    const minSpan = Math.max(frame.minSpan, ...frame.limits.map(({ value }) => headroom * value));
    const [first, end] = rowsInSpan(this.times, this.span);
    const seen = (isRight: boolean) =>
      shown
        .filter(({ series }) => (series.isRight ?? false) === isRight)
        .map(({ column }) => column.slice(first, end));
    const scale = rightPerLeft(seen(false), seen(true), minSpan);
    const right = seen(true).map((column) => Array.from(column, (value) => value / scale));
    const drawing = new PlotDrawing(
      {
        width: this.element.clientWidth || 300,
        height: TimePlot.height,
        margins,
        lanes: options.lanes ?? [],
        x: this.span,
        y: axisRange([...seen(false), ...right], minSpan),
      },
      frame.title,
    );
    drawing.axes(options.unit, options.rightUnit, scale);
    frame.marks.forEach((time) => drawing.mark(time));
    for (const { series, column } of shown) this.drawSeries(drawing, series, column, scale);
    for (const band of frame.bands) drawing.band(band);
    for (const { value, title } of frame.limits) drawing.limit(value, title);
    this.replaceDrawing(drawing.svg);
  }

  private drawSeries(
    drawing: PlotDrawing,
    series: PlotSeries,
    column: PlotColumn,
    rightScale: number,
  ): void {
    const scale = series.isRight ? rightScale : 1;
    const values = scale === 1 ? column : Array.from(column, (value) => value / scale);
    drawing.curve(this.times, values, series.color);
    const spikes = spikesOutside(this.times, values, drawing.range, drawing.spikeGap);
    const unit = this.unitOf(series);
    drawing.spikes(spikes, series.color, (value) => `${significant(value * scale)} ${unit}`);
  }

  private replaceDrawing(svg: SVGElement): void {
    this.drawing.replaceWith(svg);
    this.drawing = svg;
    Object.assign(this.over.style, {
      inset: `auto ${margins.right}px ${margins.bottom}px ${margins.left}px`,
      height: `${TimePlot.height - margins.top - margins.bottom}px`,
    });
    this.heading.setZoomed(TimePlot.isZoomed);
    this.setPlayhead(this.playheadTime);
    this.showPointed();
  }

  /// The time at the pointer with the values there.
  private showPointed(): void {
    const share = TimePlot.pointed;
    placeAt(this.pointed, share ?? NaN);
    this.readout.hidden = share === null;
    if (share === null) return;
    const time = this.timeAt(share);
    const [from, to] = this.span;
    const lines = this.shown.map(({ series, column }) => {
      const value = valueNear(this.times, column, time, pointerReach * (to - from));
      const text = Number.isFinite(value) ? `${value.toFixed(2)} ${this.unitOf(series)}` : '–';
      return create('div', {}, `${series.title}: ${text}`);
    });
    this.readout.replaceChildren(create('div', {}, `${time.toFixed(2)} s`), ...lines);
    this.readout.style.left = `${100 * share}%`;
    this.readout.classList.toggle('left', share > 0.6);
  }
}

/// Shows a vertical line at a share of the width, or hides it outside.
function placeAt(line: HTMLElement, share: number): void {
  line.hidden = !(share >= 0 && share <= 1);
  if (!line.hidden) line.style.left = `${(100 * share).toFixed(2)}%`;
}
