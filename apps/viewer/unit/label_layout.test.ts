// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { clearOf, overlap, type Area } from '../src/ui/label_layout';

const stage = { width: 390, height: 400 };
const label: Area = { left: 100, top: 100, width: 80, height: 20 };

test('a label stays where nothing is in its way', () => {
  assert.deepEqual(clearOf(label, [{ left: 0, top: 0, width: 50, height: 50 }], stage), label);
});

test('a label moves the shortest way beside what is there, on the stage', () => {
  const ring = { left: 90, top: 95, width: 44, height: 44 };
  const above = clearOf(label, [ring], stage);
  assert.deepEqual([above.left, above.top], [100, 95 - 20 - 4]);
  const hud = { left: 0, top: 60, width: 390, height: 32 };
  const below = clearOf(label, [ring, hud], stage);
  assert.ok(![ring, hud].some((area) => overlap(below, area)));
  assert.ok(below.left >= 0 && below.left + below.width <= stage.width);
});

test('two labels at one place are put beside each other', () => {
  const other = clearOf(label, [label], stage);
  assert.ok(!overlap(other, label));
});

test('a label stays at its body where no place is free', () => {
  const all = { left: 0, top: 0, ...stage };
  assert.deepEqual(clearOf(label, [all], stage), label);
});
