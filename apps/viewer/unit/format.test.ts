// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { count } from '../src/ui/format';

test('a count has three digits at most', () => {
  assert.equal(count(12), '12');
  assert.equal(count(999), '999');
  assert.equal(count(19_999), '20 k');
  assert.equal(count(74_880), '74.9 k');
  assert.equal(count(300_000), '300 k');
});
