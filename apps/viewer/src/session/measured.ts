// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LinkInfo } from '../link_protocol';
import type { LiveState, Vector } from '../protocol';

const historySeconds = 5; // of the predicted world: longer than a round trip
const minShift = 0.0002; // [m] a correction that moves an object by less is not seen

/// How an object's prediction compares with its tracking at the robot's site.
export interface Comparison {
  age: number; // [s] of the newest tracked pose
  error: number; // [m] from what was predicted for its instant; NaN where that is not known
  shift: number; // [m] by which the last correction moved the prediction; NaN before the first
  shiftAge: number; // [s] since that correction
}

interface Shown {
  time: number; // [s] of the world
  positions: readonly Vector[];
}

/// How old the newest state of the robot is [s]; NaN where no command's way is known.
export function stateAge(clock: number, link: LinkInfo): number {
  return link.stamps ? Math.max(0, clock - link.stamps.sensed) : NaN;
}

/// The world's time [s] that the newest state of the robot is about.
export function measuredTime({ clock, worldTime }: LiveState, link: LinkInfo): number {
  return worldTime - link.lead - stateAge(clock, link);
}

/// Compares, at an operator's site, the predicted world with what the robot's site measures later.
export class Measured {
  private history: Shown[] = [];
  private corrections = 0;
  private shifts: { shift: number; time: number }[] = [];

  add(state: LiveState): void {
    const robot = state.link?.robot;
    const last = this.history.at(-1);
    if (!robot || (last && state.worldTime <= last.time)) this.clear();
    if (!robot) return;
    if (last && robot.corrections !== this.corrections) this.addShifts(state, last);
    this.corrections = robot.corrections;
    this.history.push({
      time: state.worldTime,
      positions: state.objects.map(({ position }) => position),
    });
    const oldest = state.worldTime - historySeconds;
    while (this.history[0].time < oldest) this.history.shift();
  }

  /// Of one object; null without tracking of it.
  compare(state: LiveState, index: number): Comparison | null {
    const { link } = state;
    const tracked = link?.robot?.objects[index];
    if (!link || !tracked?.isTracked) return null;
    const predicted = this.positionAt(measuredTime(state, link) - tracked.age, index);
    const { shift, time } = this.shifts[index] ?? { shift: NaN, time: NaN };
    return {
      age: stateAge(state.clock, link) + tracked.age,
      error: predicted ? distance(predicted, tracked.position) : NaN,
      shift,
      shiftAge: state.worldTime - time,
    };
  }

  private clear(): void {
    this.history = [];
    this.shifts = [];
  }

  /// A correction moves an object at once; what it would have moved anyway is taken off.
  private addShifts({ worldTime, objects }: LiveState, last: Shown): void {
    objects.forEach(({ position, speed }, i) => {
      const moved = distance(position, last.positions[i] ?? position);
      const shift = Math.max(0, moved - speed * (worldTime - last.time));
      if (shift >= minShift) this.shifts[i] = { shift, time: worldTime };
    });
  }

  private positionAt(time: number, index: number): Vector | null {
    const after = this.history.findIndex((shown) => shown.time >= time);
    if (!(after > 0)) return null;
    const [a, b] = [this.history[after - 1], this.history[after]];
    const ratio = (time - a.time) / (b.time - a.time);
    const [p, q] = [a.positions[index], b.positions[index]];
    return p && q ? (p.map((value, i) => value + ratio * (q[i] - value)) as Vector) : null;
  }
}

function distance(a: readonly number[], b: readonly number[]): number {
  return Math.hypot(...a.map((value, i) => value - b[i]));
}
