// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Phase, Quaternion, Vector } from '../protocol';

interface TableAt {
  at: number; // [bytes] from the start of replay.bin
  rows: number;
}

/// `/api/replay.json`; times [s] from `start`.
export interface ReplayModel {
  duration: number;
  start: number;
  delays: { forward: number; backward: number };
  parameters: string | null;
  objects: {
    name: string;
    predicted: TableAt;
    tracked: TableAt;
    force: TableAt;
    error: TableAt;
    phases: { t: number; measured: Phase; predicted: Phase }[];
  }[];
  tool: TableAt;
  arm: TableAt | null;
  corrections: { t: number; object: string; case: number | string; what: string; bytes: number }[];
  frames: { t: number[]; width: number; height: number };
}

/// The index of the last of `count` ascending times not after `time`; -1 if all are after it.
function lastNotAfter(time: number, count: number, timeOf: (index: number) => number): number {
  let [low, high] = [0, count];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeOf(middle) <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/// Rows of numbers; the first column is the time, ascending.
export class Table {
  constructor(
    readonly values: Float32Array,
    readonly width: number,
  ) {}

  get rows(): number {
    return this.values.length / this.width;
  }

  time(row: number): number {
    return this.values[row * this.width];
  }

  column(index: number): Float64Array {
    return Float64Array.from(
      { length: this.rows },
      (_, row) => this.values[row * this.width + index],
    );
  }

  /// The last row not after `time`; -1 if all are after it.
  rowAt(time: number): number {
    return lastNotAfter(time, this.rows, (row) => this.time(row));
  }

  /// Values at `time`, linearly interpolated between two rows; null outside of the table.
  at(time: number): number[] | null {
    const row = this.rowAt(time);
    if (row < 0) return null;
    const from = this.row(row);
    if (row + 1 === this.rows) return time <= from[0] + maxHold ? from : null;
    const to = this.row(row + 1);
    const fraction = (time - from[0]) / (to[0] - from[0]);
    return from.map((value, i) => value + (to[i] - value) * fraction);
  }

  private row(row: number): number[] {
    return Array.from(this.values.subarray(row * this.width, (row + 1) * this.width));
  }
}

const maxHold = 0.5; // [s] for which the last value stays valid

export interface PoseAt {
  position: Vector;
  quaternion: Quaternion;
}

/// The pose at `time` from rows t, position, quaternion; rotations are interpolated along the
/// shorter arc (normalised lerp).
export function poseAt(table: Table, time: number): PoseAt | null {
  // A prediction begins with the first cycle: before it, the first pose holds.
  const first = table.rows > 0 ? table.time(0) : Infinity;
  if (time < first && first - time <= maxHold) time = first;
  const row = table.rowAt(time);
  const values = table.at(time);
  if (!values) return null;
  const position: Vector = [values[1], values[2], values[3]];
  const from = table.values.subarray(row * 8 + 4, row * 8 + 8);
  const next = Math.min(row + 1, table.rows - 1);
  const to = table.values.subarray(next * 8 + 4, next * 8 + 8);
  const dot = from[0] * to[0] + from[1] * to[1] + from[2] * to[2] + from[3] * to[3];
  const span = table.time(next) - table.time(row);
  const fraction = span > 0 ? Math.min(1, (time - table.time(row)) / span) : 0;
  const mixed = Array.from(from, (q, i) => q + ((dot < 0 ? -to[i] : to[i]) - q) * fraction);
  const norm = Math.hypot(...mixed) || 1;
  return { position, quaternion: mixed.map((q) => q / norm) as Quaternion };
}

export interface ReplayObject {
  name: string;
  predicted: Table;
  tracked: Table;
  force: Table;
  error: Table;
  phases: { t: number; measured: Phase; predicted: Phase }[];
}

export interface Replay {
  model: ReplayModel;
  objects: ReplayObject[];
  tool: Table;
  arm: Table | null;
}

/// Splits replay.bin into tables; throws an Error if it is shorter than replay.json declares.
/// `coordinates`: of the scene's arm.
export function readReplay(model: ReplayModel, binary: ArrayBuffer, coordinates = 0): Replay {
  const table = ({ at, rows }: TableAt, width: number) => {
    if (at % 4 !== 0 || at + 4 * rows * width > binary.byteLength)
      throw new Error('replay.bin is shorter than replay.json declares');
    return new Table(new Float32Array(binary, at, rows * width), width);
  };
  return {
    model,
    tool: table(model.tool, 7),
    arm: model.arm ? table(model.arm, 1 + coordinates) : null,
    objects: model.objects.map((object) => ({
      name: object.name,
      phases: object.phases,
      predicted: table(object.predicted, 8),
      tracked: table(object.tracked, 8),
      force: table(object.force, 3),
      error: table(object.error, 3),
    })),
  };
}

/// The phases at `time`.
export function phasesAt(
  object: ReplayObject,
  time: number,
): { measured: Phase; predicted: Phase } {
  const { phases } = object;
  const found = phases[lastNotAfter(time, phases.length, (i) => phases[i].t)];
  return found ?? { measured: 'free', predicted: 'free' };
}

/// The index of the last of ascending `times` not after `time`; 0 if all are after it, -1 if empty.
export function indexAt(times: readonly number[], time: number): number {
  const found = lastNotAfter(time, times.length, (i) => times[i]);
  return Math.max(found, Math.min(0, times.length - 1));
}
