// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Draws a plot over time as SVG, a dozen times a second: without a library, whose code would be a
// third of the page's.
import { roundTicks } from './plot_axes';

export type Range = readonly [number, number];

export interface Frame {
  width: number; // [CSS pixels], with the margins
  height: number;
  margins: { top: number; right: number; bottom: number; left: number };
  x: Range; // [s]
  y: Range;
}

const namespace = 'http://www.w3.org/2000/svg';
const tickSpacing = { x: 80, y: 30 }; // [CSS pixels] at least, between labels
const fontSize = 11; // [CSS pixels]

type Attributes = Record<string, string | number>;

function shape(name: string, attributes: Attributes, ...children: (Node | string)[]): SVGElement {
  const element = document.createElementNS(namespace, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}

/// The drawing of one plot; parts are drawn in the order of the calls.
export class PlotDrawing {
  readonly svg: SVGElement;
  private readonly inside: SVGElement; // clipped to the axes
  private static count = 0;

  constructor(
    private readonly frame: Frame,
    title: string,
  ) {
    const { width, height, margins } = frame;
    const clip = `plot-area-${PlotDrawing.count++}`;
    const area = shape('rect', {
      x: margins.left,
      y: margins.top,
      width: Math.max(0, width - margins.left - margins.right),
      height: height - margins.top - margins.bottom,
    });
    this.inside = shape('g', { 'clip-path': `url(#${clip})` });
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
      shape('clipPath', { id: clip }, area),
    );
  }

  x(value: number): number {
    const { width, margins, x } = this.frame;
    const share = (value - x[0]) / (x[1] - x[0]);
    return margins.left + share * (width - margins.left - margins.right);
  }

  y(value: number): number {
    const { height, margins, y } = this.frame;
    const share = (value - y[0]) / (y[1] - y[0]);
    return height - margins.bottom - share * (height - margins.top - margins.bottom);
  }

  /// Grid, ticks and units. `rightUnit` with the units of the right axis per unit of the left one.
  axes(unit: string, rightUnit?: string, rightPerLeft = 1): void {
    const { width, height, margins, x, y } = this.frame;
    const [bottom, right] = [height - margins.bottom, width - margins.right];
    const xTicks = roundTicks(x, (right - margins.left) / tickSpacing.x);
    const yTicks = roundTicks(y, (bottom - margins.top) / tickSpacing.y);
    const lines = [
      ...xTicks.map((at) => `M${this.x(at)},${margins.top}V${bottom}`),
      ...yTicks.map((at) => `M${margins.left},${this.y(at)}H${right}`),
    ];
    const text = (at: number, atY: number, anchor: string, content: string) =>
      shape('text', { x: at, y: atY, 'text-anchor': anchor }, content.replace('-', '−'));
    const label = (values: readonly number[], name: string, make: (at: number) => SVGElement) =>
      shape('g', { 'aria-label': `${name}-axis tick label` }, ...values.map(make));
    this.svg.append(
      shape('path', { d: lines.join(''), stroke: 'var(--grid)' }),
      label(xTicks, 'x', (at) => text(this.x(at), bottom + 16, 'middle', tickText(at))),
      label(yTicks, 'y', (at) => text(margins.left - 6, this.y(at) + 4, 'end', tickText(at))),
      text(2, margins.top - 4, 'start', unit),
      text(width - 2, bottom + 16, 'end', 's'),
    );
    if (rightUnit)
      this.svg.append(
        label(yTicks, 'right', (at) =>
          text(right + 6, this.y(at) + 4, 'start', tickText(at * rightPerLeft)),
        ),
        text(width - 2, margins.top - 4, 'end', rightUnit),
      );
    this.svg.append(this.inside);
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
    this.inside.append(shape('path', { d: path, 'aria-label': 'line', ...style }));
  }

  /// A dashed vertical line.
  mark(time: number): void {
    const { height, margins } = this.frame;
    const d = `M${this.x(time)},${margins.top}V${height - margins.bottom}`;
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

  /// A bar `top` below the upper axis.
  band(from: number, to: number, top: number, height: number, color: string): void {
    const [left, right] = [this.x(from), this.x(to)];
    this.inside.append(
      shape('rect', {
        x: left,
        y: this.frame.margins.top + top,
        width: Math.max(1, right - left),
        height,
        fill: color,
      }),
    );
  }
}

function tickText(value: number): string {
  return String(Number(value.toPrecision(6)));
}
