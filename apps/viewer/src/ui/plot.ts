// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { create } from './dom';

export interface PlotSeries {
  title: string;
  color: string;
  scale?: string; // a second axis, on the right
}

export interface PlotOptions {
  title: string;
  note?: string; // legend of bands and marks
  unit: string;
  rightUnit?: string;
  series: PlotSeries[];
  height: number; // [CSS pixels]
  onSeek?: (time: number) => void;
  /// Draws below the curves, in canvas pixels.
  drawBelow?: (plot: uPlot) => void;
  minSpan: number; // of the left axis: noise about zero is not scaled up to fill the plot
}

/// A plot over time [s], in the page's colours and as wide as its container.
export class Plot {
  readonly element = create('div', { className: 'plot' });
  private readonly plot: uPlot;
  private playheadTime = NaN; // [s]; NaN: none
  private span: [number, number] = [0, 1]; // [s] shown
  private readonly playhead = create('div', { className: 'playhead', hidden: true });
  private readonly observer: ResizeObserver;

  constructor(parent: HTMLElement, options: PlotOptions) {
    this.element.append(this.heading(options));
    parent.append(this.element);
    this.plot = new uPlot(
      this.settings(options),
      [[0], ...options.series.map(() => [null])],
      this.element,
    );
    this.plot.over.append(this.playhead);
    if (options.onSeek) this.seekByPointer(options.onSeek);
    this.observer = new ResizeObserver(() =>
      this.plot.setSize({ width: this.element.clientWidth, height: options.height }),
    );
    this.observer.observe(this.element);
  }

  /// A NaN interrupts its curve.
  setData(times: readonly number[], columns: ArrayLike<number>[], from: number, to: number): void {
    this.span = [from, to];
    const curves = columns.map((column) => Array.from(column, (v) => (Number.isNaN(v) ? null : v)));
    this.plot.setData([times as number[], ...curves]);
  }

  setPlayhead(time: number): void {
    this.playheadTime = time;
    this.placePlayhead();
  }

  /// To be called after a change of the page's colours.
  redraw(): void {
    this.plot.redraw(false, true);
  }

  remove(): void {
    this.observer.disconnect();
    this.plot.destroy();
    this.element.remove();
  }

  private heading({ title, note, series }: PlotOptions): HTMLElement {
    const keys = series.map(({ title: text, color }) => {
      const key = create('span', { className: 'key', textContent: text });
      key.style.setProperty('--key', color);
      return key;
    });
    const notes = note ? [create('span', { className: 'note', textContent: note })] : [];
    return create('h3', {}, create('span', { textContent: title }), ...keys, ...notes);
  }

  private settings(options: PlotOptions): uPlot.Options {
    const axis = (unit: string, scale: string, side: number): uPlot.Axis => ({
      scale,
      side,
      size: 46,
      stroke: () => cssColor('--muted'),
      grid: { show: side === 3, stroke: () => cssColor('--grid'), width: 1 },
      ticks: { show: false },
      font: '11px system-ui, sans-serif',
      values: (_, values) =>
        values.map((value, i) => (i === values.length - 1 ? `${value} ${unit}` : `${value}`)),
    });
    const right = options.rightUnit ? [axis(options.rightUnit, 'right', 1)] : [];
    const range: uPlot.Range.Function = (_, min, max) => [
      Math.min(0, min ?? 0),
      Math.max(options.minSpan, (max ?? 0) * 1.08),
    ];
    return {
      width: this.element.clientWidth || 300,
      height: options.height,
      padding: [6, options.rightUnit ? 0 : 12, 0, 0],
      cursor: {
        y: false,
        drag: { x: false, y: false },
        sync: { key: 'pcavr' },
        points: { show: false },
      },
      legend: { show: false },
      scales: { x: { time: false, range: () => this.span }, y: { range }, right: { range } },
      axes: [
        { ...axis('s', 'x', 2), size: 24, grid: { stroke: () => cssColor('--grid'), width: 1 } },
        axis(options.unit, 'y', 3),
        ...right,
      ],
      series: [
        {},
        ...options.series.map(({ color, scale }) => ({
          stroke: color,
          width: 1.4,
          scale: scale ?? 'y',
          points: { show: false },
        })),
      ],
      hooks: {
        drawAxes: options.drawBelow ? [options.drawBelow] : [],
        draw: [() => this.placePlayhead()],
      },
    };
  }

  /// Repeated after each draw: before the first one the plot's time scale is not set.
  private placePlayhead(): void {
    const x = this.plot.valToPos(this.playheadTime, 'x');
    this.playhead.hidden = !Number.isFinite(x);
    this.playhead.style.transform = `translateX(${x.toFixed(1)}px)`;
  }

  private seekByPointer(onSeek: (time: number) => void): void {
    const seek = (event: PointerEvent) => {
      const box = this.plot.over.getBoundingClientRect();
      onSeek(this.plot.posToVal(event.clientX - box.left, 'x'));
    };
    this.plot.over.addEventListener('pointerdown', (event) => {
      this.plot.over.setPointerCapture(event.pointerId);
      seek(event);
    });
    this.plot.over.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) seek(event);
    });
  }
}

export function cssColor(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
