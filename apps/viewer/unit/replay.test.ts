// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decimate } from '../src/replay/decimation';
import {
  indexAt,
  phasesAt,
  poseAt,
  readReplay,
  Table,
  type ReplayModel,
  type ReplayObject,
} from '../src/replay/replay_data';
import { Timeline } from '../src/replay/timeline';

test('a timeline plays at its speed and stops at its end', () => {
  const timeline = new Timeline(10);
  assert.equal(timeline.advance(1), false);
  timeline.toggle();
  timeline.speed = 4;
  assert.equal(timeline.advance(2), true);
  assert.equal(timeline.time, 8);
  timeline.advance(2);
  assert.equal(timeline.time, 10);
  assert.equal(timeline.isPlaying, false);
});

test('a timeline played at its end restarts', () => {
  const timeline = new Timeline(10);
  timeline.seek(10);
  timeline.toggle();
  assert.equal(timeline.time, 0);
  assert.equal(timeline.isPlaying, true);
});

test('a seek is clamped to the timeline', () => {
  const timeline = new Timeline(10);
  for (const [wanted, got] of [
    [-1, 0],
    [99, 10],
    [NaN, 0],
    [2.5, 2.5],
  ]) {
    timeline.seek(wanted);
    assert.equal(timeline.time, got);
  }
});

const table = new Table(Float32Array.of(0, 10, 1, 20, 3, 40), 2);

test('values between two rows are interpolated linearly', () => {
  assert.deepEqual(table.at(0), [0, 10]);
  assert.deepEqual(table.at(2), [2, 30]);
  assert.deepEqual(table.at(3), [3, 40]);
});

test('a table has no values outside of its rows, but holds the last one for a while', () => {
  assert.equal(table.at(-0.1), null);
  assert.deepEqual(table.at(3.4), [3, 40]);
  assert.equal(table.at(4), null);
  assert.equal(new Table(new Float32Array(), 2).at(0), null);
});

test('rows with equal times do not divide by zero', () => {
  const twice = new Table(Float32Array.of(0, 1, 0, 2, 1, 3), 2);
  assert.deepEqual(twice.at(0), [0, 2]);
});

test('a pose rotates along the shorter arc, whatever the sign of its quaternion', () => {
  const s = Math.SQRT1_2;
  const poses = new Table(Float32Array.of(0, 1, 0, 0, 0, 0, 0, 1, 1, 3, 0, 0, 0, 0, -s, -s), 8);
  const half = poseAt(poses, 0.5)!;
  assert.deepEqual(half.position, [2, 0, 0]);
  const angle = (2 * Math.atan2(half.quaternion[2], half.quaternion[3]) * 180) / Math.PI;
  // Half of 90 degrees; the errors of floats and of linear interpolation are far below 0.1.
  assert.ok(Math.abs(angle - 45) < 0.1, `${angle}`);
  assert.ok(Math.abs(Math.hypot(...half.quaternion) - 1) < 1e-12);
});

test('before its first row a body has its first pose', () => {
  const poses = new Table(Float32Array.of(0.2, 1, 2, 3, 0, 0, 0, 1, 1, 3, 0, 0, 0, 0, 0, 1), 8);
  assert.deepEqual(poseAt(poses, 0)!.position, [1, 2, 3]);
  assert.equal(poseAt(poses, -1), null);
});

test('a replay shorter than declared is rejected', () => {
  const empty = { at: 0, rows: 0 };
  const model = { tool: { at: 4, rows: 1 }, objects: [] } as unknown as ReplayModel;
  assert.throws(() => readReplay(model, new ArrayBuffer(28)), /shorter/);
  assert.throws(() => readReplay({ ...model, tool: { at: 2, rows: 0 } }, new ArrayBuffer(28)));
  assert.equal(readReplay({ ...model, tool: empty }, new ArrayBuffer(0)).tool.rows, 0);
});

test('a phase lasts until the next one', () => {
  const object = {
    phases: [
      { t: 1, measured: 'static', predicted: 'free' },
      { t: 2, measured: 'sliding', predicted: 'critical' },
    ],
  } as unknown as ReplayObject;
  assert.equal(phasesAt(object, 0).measured, 'free');
  assert.equal(phasesAt(object, 1.9).measured, 'static');
  assert.equal(phasesAt(object, 50).predicted, 'critical');
});

test('the image shown is the newest one not after the time', () => {
  assert.equal(indexAt([0.5, 1, 1.5], 1.2), 1);
  assert.equal(indexAt([0.5, 1, 1.5], 0), 0);
  assert.equal(indexAt([0.5, 1, 1.5], 9), 2);
  assert.equal(indexAt([], 9), -1);
});

test('decimation keeps a peak of a single row', () => {
  const column = new Float64Array(100_000);
  column[54_321] = 7;
  column[777] = -3;
  const rows = decimate([column], 500);
  assert.ok(rows.length <= 1002);
  assert.ok(rows.includes(54_321) && rows.includes(777));
  assert.ok(rows.includes(0) && rows.includes(99_999));
  assert.deepEqual(
    rows,
    [...rows].sort((a, b) => a - b),
  );
});

test('decimation keeps a gap and a peak next to it', () => {
  const column = new Float64Array(100_000);
  for (const row of [0, 200, 50_000]) column[row] = NaN;
  column[50_001] = 7;
  const rows = decimate([column], 500);
  assert.deepEqual(
    rows.filter((row) => Number.isNaN(column[row])),
    [0, 200, 50_000],
  );
  assert.ok(rows.includes(50_001));
  assert.ok(rows.length <= 1503);
});

test('a short series is not decimated', () => {
  assert.deepEqual(decimate([Float64Array.of(1, 2, 3)], 10), [0, 1, 2]);
  assert.deepEqual(decimate([], 10), []);
});
