// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';

export interface LatencyFigures {
  stateRate: number; // [Hz] states taken in over the last second
  drawRate: number; // [Hz]
  age: number; // [s] of the newest state now, on the server's clock; NaN before the first
  // The way of a command [s], medians over the last seconds, NaN where nothing went it; its stages
  // add up to the whole.
  commandToWorld: number; // until a state of the world shows that it was used
  worldToPage: number; // until that state is here
  pageToPicture: number; // until it is drawn
  commandToDrawn: number;
  oldestDrawn: number; // [s] the oldest state drawn in the last seconds
}

const keepSeconds = 5; // of samples: enough for a steady median, short enough to follow a change

/// The middle of some numbers; NaN of none.
export function median(values: readonly number[]): number {
  if (values.length === 0) return NaN;
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/// NaN of none.
function largest(values: readonly number[]): number {
  return values.reduce((most, value) => (value > most ? value : most), values[0] ?? NaN);
}

/// Values of the last seconds, each with its time [s].
export class RecentValues {
  private times: number[] = [];
  private values: number[] = [];
  constructor(private readonly seconds: number) {}

  add(time: number, value: number): void {
    this.times.push(time);
    this.values.push(value);
    this.forget(time);
  }

  at(now: number): readonly number[] {
    this.forget(now);
    return this.values;
  }

  private forget(now: number): void {
    let old = 0;
    while (old < this.times.length && this.times[old] < now - this.seconds) ++old;
    if (old > 0) {
      this.times.splice(0, old);
      this.values.splice(0, old);
    }
  }
}

/// How far the picture lags behind the world, and behind the hand. All clocks in seconds.
export class Latency {
  private arrivals = new RecentValues(1);
  private draws = new RecentValues(1);
  private underway = new RecentValues(keepSeconds);
  private commandToWorld = new RecentValues(keepSeconds);
  private pageToPicture = new RecentValues(keepSeconds);
  private commandToDrawn = new RecentValues(keepSeconds);
  private drawnAges = new RecentValues(keepSeconds);
  private newest: LiveState | null = null;
  private clockOffset = NaN; // server's clock less ours
  private receivedAt = NaN;
  private receivedToolClock = NaN;
  private drawnToolClock = NaN;

  received(state: LiveState, now: number, clockOffset: number): void {
    this.newest = state;
    this.clockOffset = clockOffset;
    this.arrivals.add(now, 1);
    const underway = now + clockOffset - state.clock + state.age.state;
    if (Number.isFinite(underway)) this.underway.add(now, Math.max(0, underway));
    this.receivedAt = now;
    const { toolClock } = state;
    if (!Number.isFinite(toolClock) || toolClock === this.receivedToolClock) return;
    this.receivedToolClock = toolClock;
    const toWorld = state.clock - state.age.state - (toolClock + clockOffset);
    if (Number.isFinite(toWorld)) this.commandToWorld.add(now, Math.max(0, toWorld));
  }

  drawn(state: LiveState, now: number): void {
    this.draws.add(now, 1);
    const age = this.age(now);
    if (Number.isFinite(age)) this.drawnAges.add(now, age);
    // Each sample counts once, when a picture shows it first.
    if (!Number.isFinite(state.toolClock) || state.toolClock === this.drawnToolClock) return;
    this.drawnToolClock = state.toolClock;
    this.commandToDrawn.add(now, now - state.toolClock);
    this.pageToPicture.add(now, now - this.receivedAt);
  }

  figures(now: number): LatencyFigures {
    return {
      stateRate: this.arrivals.at(now).length,
      drawRate: this.draws.at(now).length,
      age: this.age(now),
      commandToWorld: median(this.commandToWorld.at(now)),
      worldToPage: median(this.underway.at(now)),
      pageToPicture: median(this.pageToPicture.at(now)),
      commandToDrawn: median(this.commandToDrawn.at(now)),
      oldestDrawn: largest(this.drawnAges.at(now)),
    };
  }

  /// By how much the newest state is older at `now` than one is at best when it comes [s].
  lag(now: number): number {
    return this.age(now) - this.underway.at(now).reduce((a, b) => Math.min(a, b), Infinity);
  }

  /// [s] of the newest state at `now`; NaN before the first.
  age(now: number): number {
    if (!this.newest) return NaN;
    return Math.max(0, now + this.clockOffset - this.newest.clock + this.newest.age.state);
  }
}
