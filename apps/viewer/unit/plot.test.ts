// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { valuesByX } from '../src/report/values';
import { spacingOf } from '../src/scene/cells';
import { phaseRuns } from '../src/ui/live_plot';
import {
  axisRange,
  nearestRow,
  rightPerLeft,
  roundTicks,
  rowsInSpan,
  steadyTop,
  valueNear,
} from '../src/ui/plot_axes';
import { csvText } from '../src/ui/plot_files';
import { spikesOutside } from '../src/ui/plot_spikes';

test('an axis has zero, its least span, and room above the maximum', () => {
  assert.deepEqual(axisRange([[0.1, 0.2]], 2), [0, 2]);
  assert.deepEqual(axisRange([[NaN, -3, 10]], 2), [-3.24, 10.8]);
  assert.deepEqual(axisRange([], 2), [0, 2]);
});

test('the right axis is a round multiple of the left one, and its curves fit', () => {
  assert.equal(rightPerLeft([[10]], [], 1), 1);
  for (const [left, right, scale] of [
    [10, 10, 1],
    [10, 13, 2],
    [10, 45, 5],
    [10, 60, 10],
    [100, 3, 0.05],
    [50, 0.001, 0.02], // at least the least span
  ]) {
    const got = rightPerLeft([[left]], [[right]], 1);
    assert.ok(Math.abs(got / scale - 1) < 1e-12, `${left} and ${right}: ${got}`);
  }
});

test('the nearest row is found at both ends, between rows, and not in an empty plot', () => {
  const times = [1, 2, 4];
  assert.deepEqual(
    [0, 1.4, 1.6, 2.9, 3.1, 9].map((time) => nearestRow(times, time)),
    [0, 0, 1, 1, 2, 2],
  );
  assert.equal(nearestRow([], 1), -1);
});

test('there is no value in a gap, nor outside', () => {
  const [times, values] = [
    [1, 2, 2, 8, 9],
    [5, 6, NaN, 7, 8],
  ];
  const at = (time: number) => valueNear(times, values, time, 0.1);
  assert.deepEqual([0.5, 0.95, 1.4, 5, 7.95, 8.4, 9.5].map(at), [NaN, 5, 5, NaN, 7, 7, NaN]);
  assert.ok(Number.isNaN(valueNear([], [], 1, 1)));
});

test('the top of an axis stays while the values fit and use it', () => {
  assert.equal(steadyTop(0, 2, 2), 2);
  assert.equal(steadyTop(3, 2, 2), 5);
  assert.equal(steadyTop(4.6, 5, 2), 5); // with its room above
  assert.equal(steadyTop(4.7, 5, 2), 10);
  assert.equal(steadyTop(4.2, 10, 2), 10);
  assert.equal(steadyTop(3, 10, 2), 5);
});

test('a table is saved with quoted names and words, and gaps stay empty', () => {
  const table = [
    { name: 'time (s)', values: [0, 0.5] },
    { name: 'a, "b" (N)', values: [NaN, -2] },
    { name: 'phase', values: ['free', 'on, off'] },
  ];
  assert.equal(csvText(table), 'time (s),"a, ""b"" (N)",phase\r\n0,,free\r\n0.5,-2,"on, off"\r\n');
});

/// About 7 N for two of ten seconds, otherwise nothing.
const push = Array.from({ length: 1000 }, (_, i) => (i % 500 < 100 ? 7 + 0.2 * Math.sin(i) : 0));

test('one spike does not flatten the curve', () => {
  const hit = push.map((value, i) => (i === 3 ? 72 : value));
  const [, high] = axisRange([hit], 2);
  assert.ok(high > 7 && high < 9, `${high} N`);
});

test('a curve about zero has no spike that flattens the others', () => {
  const aboutZero = push.map((_, i) => (i === 40 ? -30 : 0.1 * Math.sin(i)));
  const [low] = axisRange([push, aboutZero], 2);
  assert.ok(low > -1, `${low} N`);
});

test('what is not rare is no spike: a press, a breakaway, a short contact, noise', () => {
  const press = Array.from({ length: 200 }, (_, i) => i / 10);
  assert.ok(axisRange([press], 2)[1] > 19.9);
  const breakaway = push.map((value, i) => (i % 500 < 5 ? 2 * value : value));
  assert.ok(axisRange([breakaway], 2)[1] > 14);
  const short = Array.from({ length: 1000 }, (_, i) => (i > 500 && i < 510 ? 7 : 0.05));
  assert.ok(axisRange([short], 2)[1] > 7);
  assert.ok(axisRange([[0, 0, 50, 0]], 2)[1] > 50, 'of a few values');
});

test('a spike of either sign is marked once, with its largest value', () => {
  const times = [0, 1, 2, 3, 4, 5, 6];
  assert.deepEqual(spikesOutside(times, [0, 50, 72, NaN, -30, 0, 60], [-10, 10], 1.5), [
    { time: 2, value: 72 },
    { time: 4, value: -30 },
    { time: 6, value: 60 },
  ]);
});

test('the rows of a span reach one beyond its ends', () => {
  assert.deepEqual(rowsInSpan([0, 1, 2, 3, 4], [1.5, 2.5]), [1, 4]);
  assert.deepEqual(rowsInSpan([0, 1], [-5, 9]), [0, 3]);
});

test('equal phases in a row are one band, and free is none', () => {
  const phases = ['free', 'static', 'static', 'sliding', 'free'] as const;
  const samples = phases.map((phase, i) => ({ time: i, phase }));
  assert.deepEqual(
    phaseRuns(samples, 4).map(({ from, to }) => [from, to]),
    [
      [-3, -1],
      [-1, 0],
    ],
  );
});

test('the values at a time are those of all curves, unless one has a gap there', () => {
  const rows = valuesByX([
    { label: 'a', color: 0, x: [0, 1, 2, 3], y: [5, 6, 7, 8] },
    { label: 'b', color: 1, x: [0, 1, null], y: [1, 2, null] },
  ]);
  assert.deepEqual(rows[1], { x: 1, y: 6, values: ['a 6', 'b 2'] });
  assert.deepEqual(rows[3].values, ['a 8', 'b –']);
});

test('the spacing of points is the median distance of neighbours', () => {
  const grid = [0, 1, 2, 3].flatMap((x) => [0, 1, 2, 3].flatMap((y) => [4 * x, 4 * y, 7]));
  assert.ok(Math.abs(spacingOf(Uint16Array.from(grid), 0.002) - 0.008) < 1e-12);
  assert.equal(spacingOf(Uint16Array.of(1, 2, 3), 0.002), 0);
});

test('ticks are round, in the range, and not too many', () => {
  const rounded = (values: number[]) => values.map((value) => Number(value.toFixed(9)) + 0);
  assert.deepEqual(rounded(roundTicks([-10, 0], 5)), [-10, -8, -6, -4, -2, 0]);
  assert.deepEqual(rounded(roundTicks([0.3, 1.1], 4)), [0.4, 0.6, 0.8, 1]);
  assert.deepEqual(roundTicks([0, 0], 4), []);
});
