// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { typeset, printed } from '../src/report/typeset';

test('units and uncertainties are set as in print', () => {
  assert.equal(typeset('stiffness 57353 N/m^n'), 'stiffness 57353 N/mⁿ');
  assert.equal(typeset('N s/m^(n+1)'), 'N s/mⁿ⁺¹');
  assert.equal(typeset('N s/m^2.5, 3 m^2'), 'N s/m²·⁵, 3 m²');
  assert.equal(typeset('Limiting friction F_M'), 'Limiting friction Fₘ');
  assert.equal(typeset('0.3 +- 0.1 mm'), '0.3 ± 0.1 mm');
});

test('no line ends inside a unit or before it', () => {
  assert.equal(printed('N s/mⁿ⁺¹'), 'N\u00a0s/mⁿ⁺¹');
  assert.equal(printed('25.5 N s/m at 3 mm, 2 %'), '25.5\u00a0N\u00a0s/m at 3\u00a0mm, 2\u00a0%');
  assert.equal(printed('in 3 steps, 2 Nodes'), 'in 3 steps, 2 Nodes');
});

test('powers of ten are shown as such', () => {
  assert.equal(printed('2.77e+05 ± 0.86e+05'), '2.77·10⁵ ± 0.86·10⁵');
  assert.equal(printed('1.5e-12'), '1.5·10⁻¹²');
  assert.equal(printed('box_1e'), 'box_1e');
});

test('other text stays as it is', () => {
  for (const text of ['ham^2', 'a+-b', 'd^n', '<b>my & run</b>']) assert.equal(typeset(text), text);
});
