// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { axisRange, rightPerLeft } from '../src/ui/plot_axes';

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
