// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Draws a plot over time as SVG, a dozen times a second: without a library, whose code would be a
// third of the page's.
import { hatchClass, makeHatch } from '../hatch';
import { roundTicks } from './plot_axes';
import type { PlotBand } from './plot_options';
import type { Spike } from './plot_spikes';
import { shape } from './svg';

export type Range = readonly [number, number];

export interface Frame {
  width: number; // [CSS pixels], with the margins
  height: number;
  margins: { top: number; right: number; bottom: number; left: number };
  lanes: readonly string[]; // names of the lanes between the curves and the times
  x: Range; // [s]
  y: Range;
}

const tickSpacing = { x: 80, y: 30 }; // [CSS pixels] at least, between labels
const fontSize = 11; // [CSS pixels]
const laneHeight = 9; // [CSS pixels]
const lanePitch = 12; // [CSS pixels]
const lanesGap = 8; // [CSS pixels] from the curves
const spikeGap = 14; // [CSS pixels] nearer ones share a mark
const spikeLabelWidth = 44; // [CSS pixels]

/// What a number of lanes needs below the curves [CSS pixels].
export function heightOfLanes(count: number): number {
  return count === 0 ? 0 : lanesGap + count * lanePitch;
}

/// The drawing of one plot; parts are drawn in the order of the calls.
export class PlotDrawing {
  readonly svg: SVGElement;
  private readonly inside: SVGElement; // clipped to the axes
  private readonly insideLanes: SVGElement; // clipped to the lanes
  private hatch = ''; // a fill, once it is used
  private static count = 0;

  constructor(
    private readonly frame: Frame,
    title: string,
  ) {
    const { width, height, margins } = frame;
    const area = this.clip(margins.top, this.bottom);
    const lanes = this.clip(this.bottom, height - margins.bottom);
    this.inside = area.inside;
    this.insideLanes = lanes.inside;
    this.svg = shape(
      'svg',
      {
        width,
        height,
        viewBox: `0 0 ${width} ${height}`,
        role: 'img',
        'aria-label': title,
        'font-family': 'system-ui, sans-serif',
        'font-size': fontSize,
        fill: 'currentColor',
      },
      area.path,
      lanes.path,
    );
  }

  /// The lower end of the curves.
  private get bottom(): number {
    const { height, margins, lanes } = this.frame;
    return height - margins.bottom - heightOfLanes(lanes.length);
  }

  /// A group that shows what is between the axes, from `top` to `bottom`.
  private clip(top: number, bottom: number): { path: SVGElement; inside: SVGElement } {
    const { width, margins } = this.frame;
    const id = `plot-area-${PlotDrawing.count++}`;
    const area = shape('rect', {
      x: margins.left,
      y: top,
      width: Math.max(0, width - margins.left - margins.right),
      height: Math.max(0, bottom - top),
    });
    return {
      path: shape('clipPath', { id }, area),
      inside: shape('g', { 'clip-path': `url(#${id})` }),
    };
  }

  x(value: number): number {
    const { width, margins, x } = this.frame;
    const share = (value - x[0]) / (x[1] - x[0]);
    return margins.left + share * (width - margins.left - margins.right);
  }

  y(value: number): number {
    const { margins, y } = this.frame;
    const share = (value - y[0]) / (y[1] - y[0]);
    return this.bottom - share * (this.bottom - margins.top);
  }

  /// Grid, ticks and units. `rightUnit` with the units of the right axis per unit of the left one.
  axes(unit: string, rightUnit?: string, rightPerLeft = 1): void {
    const { width, height, margins, x, y } = this.frame;
    const [bottom, right] = [this.bottom, width - margins.right];
    const timesAt = height - margins.bottom + 16;
    const xTicks = roundTicks(x, (right - margins.left) / tickSpacing.x);
    const yTicks = roundTicks(y, (bottom - margins.top) / tickSpacing.y);
    const lines = [
      ...xTicks.map((at) => `M${this.x(at)},${margins.top}V${height - margins.bottom}`),
      ...yTicks.map((at) => `M${margins.left},${this.y(at)}H${right}`),
    ];
    const text = (at: number, atY: number, anchor: string, content: string) =>
      shape('text', { x: at, y: atY, 'text-anchor': anchor }, content.replace('-', '−'));
    const label = (values: readonly number[], name: string, make: (at: number) => SVGElement) =>
      shape('g', { 'data-mark': `${name}-axis tick label` }, ...values.map(make));
    this.svg.append(
      shape('path', { d: lines.join(''), stroke: 'var(--grid)' }),
      label(xTicks, 'x', (at) => text(this.x(at), timesAt, 'middle', tickText(at))),
      label(yTicks, 'y', (at) => text(margins.left - 6, this.y(at) + 4, 'end', tickText(at))),
      text(2, margins.top - 4, 'start', unit),
      text(width - 2, timesAt, 'end', 's'),
    );
    if (rightUnit)
      this.svg.append(
        label(yTicks, 'right', (at) =>
          text(right + 6, this.y(at) + 4, 'start', tickText(at * rightPerLeft)),
        ),
        text(width - 2, margins.top - 4, 'end', rightUnit),
      );
    this.nameLanes();
    this.svg.append(this.inside, this.insideLanes);
  }

  private nameLanes(): void {
    const { margins, lanes } = this.frame;
    const names = lanes.map((name, lane) =>
      shape(
        'text',
        { x: margins.left - 6, y: this.laneTop(lane) + laneHeight - 1, 'text-anchor': 'end' },
        name,
      ),
    );
    this.svg.append(shape('g', { 'data-mark': 'lane names', 'font-size': fontSize - 1 }, ...names));
  }

  private laneTop(lane: number): number {
    return this.bottom + lanesGap + lane * lanePitch;
  }

  curve(times: readonly number[], values: ArrayLike<number>, color: string): void {
    let path = '';
    let isOpen = false; // a NaN interrupts the curve
    for (let i = 0; i < times.length; ++i) {
      const value = values[i];
      if (Number.isFinite(value))
        path += `${isOpen ? 'L' : 'M'}${this.x(times[i]).toFixed(1)},${this.y(value).toFixed(1)}`;
      isOpen = Number.isFinite(value);
    }
    const style = { fill: 'none', stroke: color, 'stroke-width': 1.4, 'stroke-linejoin': 'round' };
    this.inside.append(shape('path', { d: path, 'data-mark': 'line', ...style }));
  }

  /// A dashed vertical line.
  mark(time: number): void {
    const d = `M${this.x(time)},${this.frame.margins.top}V${this.bottom}`;
    this.inside.append(shape('path', { d, stroke: 'currentColor', 'stroke-dasharray': '3 3' }));
  }

  /// A dashed horizontal line with its name.
  limit(value: number, title: string): void {
    const { width, margins } = this.frame;
    const at = this.y(value);
    const d = `M${margins.left},${at}H${width - margins.right}`;
    const name = shape('text', { x: margins.left + 4, y: at - 4, fill: 'var(--text)' }, title);
    this.inside.append(
      shape('path', { d, stroke: 'var(--text)', 'stroke-dasharray': '6 4' }),
      name,
    );
  }

  /// Triangles at the edge that values are beyond, with the values where there is room.
  spikes(spikes: readonly Spike[], color: string, text: (value: number) => string): void {
    const { width, margins, y } = this.frame;
    let labelEnd = -Infinity;
    for (const { time, value } of spikes) {
      const at = this.x(time);
      if (!(at >= margins.left && at <= width - margins.right)) continue;
      const isAbove = value > y[1];
      const edge = isAbove ? margins.top : this.bottom;
      const into = isAbove ? 7 : -7;
      const d = `M${at},${edge}l4,${into}h-8z`;
      this.svg.append(shape('path', { d, fill: color, 'data-mark': 'spike' }));
      if (at < labelEnd) continue;
      const isAtEnd = at > width - margins.right - spikeLabelWidth;
      const place = { x: at + (isAtEnd ? -7 : 7), y: edge + (isAbove ? 9 : -2) };
      const anchor = { 'text-anchor': isAtEnd ? 'end' : 'start' };
      const label = { ...place, ...anchor, fill: 'var(--text)', 'data-mark': 'spike value' };
      this.svg.append(shape('text', label, text(value).replace('-', '−')));
      labelEnd = at + spikeLabelWidth;
    }
  }

  /// The values that are drawn.
  get range(): Range {
    return this.frame.y;
  }

  /// How near [s] two spikes share a mark.
  get spikeGap(): number {
    const { width, margins, x } = this.frame;
    return (spikeGap * (x[1] - x[0])) / Math.max(1, width - margins.left - margins.right);
  }

  /// A bar in a lane.
  band({ from, to, lane, color }: PlotBand): void {
    const [left, right] = [this.x(from), this.x(to)];
    const width = Math.max(1, right - left);
    const bar = { x: left, y: this.laneTop(lane), width, height: laneHeight, fill: color };
    this.insideLanes.append(shape('rect', { ...bar, 'data-mark': 'phase' }));
    if (!hatchClass(color)) return;
    if (!this.hatch) {
      const { definition, fill } = makeHatch();
      this.svg.append(definition);
      this.hatch = fill;
    }
    this.insideLanes.append(shape('rect', { ...bar, fill: this.hatch }));
  }
}

function tickText(value: number): string {
  return String(Number(value.toPrecision(6)));
}
