// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { count, uncertain } from '../src/ui/format';

test('a count has three digits at most', () => {
  assert.equal(count(12), '12');
  assert.equal(count(999), '999');
  assert.equal(count(19_999), '20 k');
  assert.equal(count(74_880), '74.9 k');
  assert.equal(count(300_000), '300 k');
});

test('a value has as many digits as its standard deviation allows, as in reports', () => {
  assert.equal(uncertain(3.128, 0.207), '3.13 ± 0.21');
  assert.equal(uncertain(0.22978, 0.0048), '0.2298 ± 0.0048');
  assert.equal(uncertain(58.04, 27.6), '58 ± 28');
  assert.equal(uncertain(14989, 3208), '1.50e+04 ± 0.32e+04');
  assert.equal(uncertain(2.771e5, 8.6e4), '2.77e+05 ± 0.86e+05');
  assert.equal(uncertain(-4.5e11, 1e9), '-4.500e+11 ± 0.010e+11');
  assert.equal(uncertain(1e-12, 1e-13), '1.00e-12 ± 0.10e-12');
});

test('a value without a standard deviation stands alone', () => {
  assert.equal(uncertain(1.25, undefined), '1.25');
  assert.equal(uncertain(1.25, 0), '1.25');
  assert.equal(uncertain(3e6, Infinity), '3.00e+06');
  assert.equal(uncertain(12345.6, undefined), '12346');
  assert.equal(uncertain(0, undefined), '0');
  assert.equal(uncertain(NaN, 1), '–');
});
