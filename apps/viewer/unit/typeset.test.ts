// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { typeset } from '../src/report/typeset';

test('units and uncertainties are set as in print', () => {
  assert.equal(typeset('stiffness 57353 N/m^n'), 'stiffness 57353 N/mⁿ');
  assert.equal(typeset('N s/m^(n+1)'), 'N s/mⁿ⁺¹');
  assert.equal(typeset('N s/m^2.5, 3 m^2'), 'N s/m²·⁵, 3 m²');
  assert.equal(typeset('0.3 +- 0.1 mm'), '0.3 ± 0.1 mm');
});

test('other text stays as it is', () => {
  for (const text of ['ham^2', 'a+-b', 'd^n', '<b>my & run</b>']) assert.equal(typeset(text), text);
});
