// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import * as Plot from '@observablehq/plot';
import { create } from './dom';
import { axisRange, rightPerLeft } from './plot_axes';

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

export interface PlotOptions {
  title: string;
  note?: string; // legend of bands and marks
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
const margins = { marginTop: 16, marginBottom: 24, marginLeft: axisWidth };
const marginWithoutAxis = 22;
const bandHeight = 5;

const muted = 'var(--muted)';
const grid = { stroke: 'var(--grid)', strokeOpacity: 1 };

/// A plot over time [s], in the page's colours and as wide as its container.
export class TimePlot {
  private static readonly all = new Set<TimePlot>();

  readonly element = create('div', { className: 'plot' });
  private times: readonly number[] = [];
  private columns: readonly PlotColumn[] = [];
  private span: [number, number] = [0, 1]; // [s] shown
  private drawing: Element = create('div');
  private readonly over = create('div', { className: 'over' }); // the area inside the axes
  private readonly playhead = create('div', { className: 'playhead', hidden: true });
  private readonly pointed = create('div', { className: 'pointed', hidden: true });
  private readonly observer = new ResizeObserver(() => this.draw());
  private readonly marginRight: number;

  constructor(
    parent: HTMLElement,
    private readonly options: PlotOptions,
  ) {
    this.marginRight = options.rightUnit ? axisWidth : marginWithoutAxis;
    this.over.append(this.pointed, this.playhead);
    Object.assign(this.over.style, {
      inset: `auto ${this.marginRight}px ${margins.marginBottom}px ${margins.marginLeft}px`,
      height: `${options.height - margins.marginTop - margins.marginBottom}px`,
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
    this.span = [from, to];
    this.draw();
  }

  setPlayhead(time: number): void {
    this.place(this.playhead, time);
  }

  remove(): void {
    TimePlot.all.delete(this);
    this.observer.disconnect();
    this.element.remove();
  }

  private heading(): HTMLElement {
    const { title, note, series } = this.options;
    const keys = series.map(({ title: text, color }) => {
      const key = create('span', { className: 'key', textContent: text });
      key.style.setProperty('--key', color);
      return key;
    });
    const notes = note ? [create('span', { className: 'note', textContent: note })] : [];
    return create('h3', {}, create('span', { textContent: title }), ...keys, ...notes);
  }

  private draw(): void {
    const { options, marginRight } = this;
    const scale = rightPerLeft(this.select(false), this.select(true), options.minSpan);
    const columns = this.columns.map((column, i) =>
      options.series[i].isRight ? Array.from(column, (value) => value / scale) : column,
    );
    const drawing = Plot.plot({
      ...margins,
      marginRight,
      width: this.element.clientWidth || 300,
      height: options.height,
      ariaLabel: options.title,
      style: { fontSize: '11px', color: muted, background: 'none' },
      x: { domain: this.span },
      y: { domain: axisRange(columns, options.minSpan) },
      marks: [
        ...this.axes(scale),
        Plot.ruleX(options.marks ?? [], { stroke: muted, strokeDasharray: '3 3', clip: true }),
        ...columns.map((column, i) => this.curve(column, options.series[i].color)),
        ...this.bands(),
      ],
    });
    this.drawing.replaceWith(drawing);
    this.drawing = drawing;
  }

  private select(isRight: boolean): PlotColumn[] {
    return this.columns.filter((_, i) => (this.options.series[i].isRight ?? false) === isRight);
  }

  private axes(scale: number): Plot.Markish[] {
    const { unit, rightUnit } = this.options;
    const axis = { tickSize: 0, tickSpacing: 30, labelArrow: 'none' as const };
    const right = rightUnit && {
      ...axis,
      anchor: 'right' as const,
      label: rightUnit,
      tickFormat: (value: number) => String(Number((value * scale).toPrecision(6))),
    };
    return [
      Plot.gridX(grid),
      Plot.gridY({ ...grid, tickSpacing: axis.tickSpacing }),
      Plot.axisX({ tickSize: 0, label: 's', labelArrow: 'none', labelOffset: 18 }),
      Plot.axisY({ ...axis, label: unit }),
      ...(right ? [Plot.axisY(right)] : []),
    ];
  }

  private curve(column: PlotColumn, stroke: string): Plot.Markish {
    const { times } = this;
    return Plot.line(times, { x: times, y: column, stroke, strokeWidth: 1.4, clip: true });
  }

  private bands(): Plot.Markish[] {
    const { bands = [], height } = this.options;
    const inner = height - margins.marginTop - margins.marginBottom;
    return [0, 1].map((row) => {
      const insetTop = row * (bandHeight + 1);
      return Plot.rect(
        bands.filter((band) => band.row === row),
        {
          x1: 'from',
          x2: 'to',
          fill: 'color',
          insetTop,
          insetBottom: inner - insetTop - bandHeight,
          clip: true,
        },
      );
    });
  }

  private place(line: HTMLElement, time: number): void {
    const share = (time - this.span[0]) / (this.span[1] - this.span[0]);
    line.hidden = !(share >= 0 && share <= 1);
    if (!line.hidden) line.style.left = `${(100 * share).toFixed(2)}%`;
  }

  /// The time under the pointer is marked in all plots; pressed, the plot's user goes there.
  private addPointer(): void {
    const { over } = this;
    const { onSeek } = this.options;
    const timeAt = (event: PointerEvent) => {
      const box = over.getBoundingClientRect();
      const share = (event.clientX - box.left) / box.width;
      return this.span[0] + share * (this.span[1] - this.span[0]);
    };
    const point = (time: number) => {
      for (const plot of TimePlot.all) plot.place(plot.pointed, time);
    };
    over.addEventListener('pointermove', (event) => {
      point(timeAt(event));
      if (event.buttons & 1) onSeek?.(timeAt(event));
    });
    over.addEventListener('pointerleave', () => point(NaN));
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      onSeek?.(timeAt(event));
    });
  }
}
