// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';

export interface LatencyStats {
  stateRate: number; // [Hz] states received over the last second
  drawRate: number; // [Hz]
  age: number; // [s] of the newest state now, on the server's clock; NaN before the first
  // End-to-end (motion-to-photon, less the display) latency of a command by stages [s]: medians
  // over the last seconds, NaN without a sample. The stages add up to commandToDrawn.
  commandToWorld: number; // until a world cycle has used it
  worldToPage: number; // until the page receives that state
  pageToDrawn: number; // until that state is drawn
  commandToDrawn: number;
  maxDrawnAge: number; // [s] of the states drawn in the last seconds
}

const keepSeconds = 5; // window: enough for a steady median, short enough to follow a change

/// NaN if empty.
export function median(values: readonly number[]): number {
  if (values.length === 0) return NaN;
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/// NaN if empty.
function maxOf(values: readonly number[]): number {
  return values.reduce((max, value) => (value > max ? value : max), values[0] ?? NaN);
}

/// A sliding window: the values of the last seconds, each with its time [s].
export class SlidingWindow {
  private times: number[] = [];
  private values: number[] = [];
  constructor(private readonly seconds: number) {}

  add(time: number, value: number): void {
    this.times.push(time);
    this.values.push(value);
    this.removeOld(time);
  }

  at(now: number): readonly number[] {
    this.removeOld(now);
    return this.values;
  }

  private removeOld(now: number): void {
    let old = 0;
    while (old < this.times.length && this.times[old] < now - this.seconds) ++old;
    if (old > 0) {
      this.times.splice(0, old);
      this.values.splice(0, old);
    }
  }
}

/// Measures how far the drawn frame lags behind the world and behind the hand. Clocks in seconds.
export class Latency {
  private arrivals = new SlidingWindow(1);
  private draws = new SlidingWindow(1);
  private transit = new SlidingWindow(keepSeconds);
  private commandToWorld = new SlidingWindow(keepSeconds);
  private pageToDrawn = new SlidingWindow(keepSeconds);
  private commandToDrawn = new SlidingWindow(keepSeconds);
  private drawnAges = new SlidingWindow(keepSeconds);
  private newest: LiveState | null = null;
  private clockOffset = NaN; // the server's clock minus the page's
  private receivedAt = NaN;
  private receivedToolClock = NaN;
  private drawnToolClock = NaN;

  recordReceived(state: LiveState, now: number, clockOffset: number): void {
    this.newest = state;
    this.clockOffset = clockOffset;
    this.arrivals.add(now, 1);
    const transit = now + clockOffset - state.clock + state.age.state;
    if (Number.isFinite(transit)) this.transit.add(now, Math.max(0, transit));
    this.receivedAt = now;
    const { toolClock } = state;
    if (!Number.isFinite(toolClock) || toolClock === this.receivedToolClock) return;
    this.receivedToolClock = toolClock;
    const toWorld = state.clock - state.age.state - (toolClock + clockOffset);
    if (Number.isFinite(toWorld)) this.commandToWorld.add(now, Math.max(0, toWorld));
  }

  recordDrawn(state: LiveState, now: number): void {
    this.draws.add(now, 1);
    const age = this.age(now);
    if (Number.isFinite(age)) this.drawnAges.add(now, age);
    // Each tool sample counts once, when a frame first shows it.
    if (!Number.isFinite(state.toolClock) || state.toolClock === this.drawnToolClock) return;
    this.drawnToolClock = state.toolClock;
    this.commandToDrawn.add(now, now - state.toolClock);
    this.pageToDrawn.add(now, now - this.receivedAt);
  }

  stats(now: number): LatencyStats {
    return {
      stateRate: this.arrivals.at(now).length,
      drawRate: this.draws.at(now).length,
      age: this.age(now),
      commandToWorld: median(this.commandToWorld.at(now)),
      worldToPage: median(this.transit.at(now)),
      pageToDrawn: median(this.pageToDrawn.at(now)),
      commandToDrawn: median(this.commandToDrawn.at(now)),
      maxDrawnAge: maxOf(this.drawnAges.at(now)),
    };
  }

  /// The server's clock minus the page's [s]; NaN before the first.
  offset(): number {
    return this.clockOffset;
  }

  /// The newest state's age at `now` beyond the shortest recent transit time [s].
  lag(now: number): number {
    return this.age(now) - this.transit.at(now).reduce((a, b) => Math.min(a, b), Infinity);
  }

  /// The age of the newest state at `now` [s]; NaN before the first.
  age(now: number): number {
    if (!this.newest) return NaN;
    return Math.max(0, now + this.clockOffset - this.newest.clock + this.newest.age.state);
  }
}
