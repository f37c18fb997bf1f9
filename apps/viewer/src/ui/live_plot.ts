// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';
import { TimePlot } from './plot';
import { length } from './format';

const shownSeconds = 10;
const redrawSeconds = 1 / 12; // smooth enough for a curve
const maxSamples = 2000;
const minSpan = 2; // [N]

/// Plots the force over the last seconds.
export class LivePlot {
  private readonly plot: TimePlot;
  private times: number[] = [];
  private forces: number[] = [];
  private lastDrawn = -Infinity;

  constructor(parent: HTMLElement) {
    this.plot = new TimePlot(parent, {
      title: 'Force on the hand',
      unit: 'N',
      series: [{ title: 'magnitude', color: '#d6336c' }],
      height: 110,
      minSpan,
    });
    this.plot.setData([-shownSeconds, 0], [[NaN, NaN]], -shownSeconds, 0);
  }

  /// Adds a state; `now` [s] only limits the redraw rate.
  add(state: LiveState, now: number): void {
    const last = this.times[this.times.length - 1] ?? -Infinity;
    if (state.worldTime < last) this.clear();
    if (state.worldTime === last) return;
    this.times.push(state.worldTime);
    this.forces.push(length(state.force));
    let old = Math.max(0, this.times.length - maxSamples);
    while (this.times[old] < state.worldTime - shownSeconds) ++old;
    if (old > 64 || old === this.times.length) this.removeFirst(old);
    if (now - this.lastDrawn < redrawSeconds) return;
    this.lastDrawn = now;
    const ago = this.times.map((time) => time - state.worldTime);
    this.plot.setData(ago, [this.forces], -shownSeconds, 0);
  }

  private clear(): void {
    this.removeFirst(this.times.length);
  }

  private removeFirst(rows: number): void {
    this.times.splice(0, rows);
    this.forces.splice(0, rows);
  }
}
