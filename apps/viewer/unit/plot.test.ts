// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { valuesByX } from '../src/report/values';
import { spacingOf } from '../src/scene/cells';
import { phaseRuns } from '../src/ui/live_plot';
import { axisRange, nearestRow, rightPerLeft, roundTicks, steadyTop } from '../src/ui/plot_axes';
import { csvText } from '../src/ui/plot_files';

test('an axis has zero, its least span, and room above the maximum', () => {
  assert.deepEqual(axisRange([[0.1, 0.2]], 2), [0, 2]);
  assert.deepEqual(axisRange([[NaN, -3, 10]], 2), [-3, 10.8]);
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

test('the top of an axis stays while the values fit and use it', () => {
  assert.equal(steadyTop(0, 2, 2), 2);
  assert.equal(steadyTop(3, 2, 2), 5);
  assert.equal(steadyTop(4.6, 5, 2), 5); // with its room above
  assert.equal(steadyTop(4.7, 5, 2), 10);
  assert.equal(steadyTop(4.2, 10, 2), 10);
  assert.equal(steadyTop(3, 10, 2), 5);
});

test('numbers are saved as a table with quoted names, and gaps stay empty', () => {
  const columns = [
    [0, 0.5],
    [NaN, -2],
  ];
  assert.equal(
    csvText(['time (s)', 'a, "b" (N)'], columns),
    'time (s),"a, ""b"" (N)"\r\n0,\r\n0.5,-2\r\n',
  );
});

test('equal phases in a row are one band, and free is none', () => {
  const phases = ['free', 'static', 'static', 'sliding', 'free'] as const;
  const samples = phases.map((phase, i) => ({ time: i, force: 0, phase }));
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
