// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decodeLink, encodeLink, type LinkState } from '../src/ui/link_state';

test('a link holds view, layers and time', () => {
  const state: LinkState = {
    eye: [1.234, -2, 0.5],
    target: [0.6, 0.1, -0.025],
    layers: ['mesh', 'bodies', 'planes'],
    time: 3.25,
  };
  assert.deepEqual(decodeLink(`#${encodeLink(state)}`), state);
  assert.deepEqual(decodeLink(''), {});
  assert.deepEqual(decodeLink(encodeLink({ layers: [] })), { layers: [] });
});

test('what is not valid in a link is left out', () => {
  assert.deepEqual(decodeLink('#view=1,2,3&layers=mesh,walls&t=-1'), { layers: ['mesh'] });
  assert.deepEqual(decodeLink('#view=1,2,3,x,5,6&t=soon'), {});
  assert.deepEqual(decodeLink('#view=1,2,3,1,2,3'), {}); // no direction
  assert.deepEqual(decodeLink('#view=1e9,2,3,4,5,6&t=Infinity'), {});
  assert.deepEqual(decodeLink('#view=1,2,3,,5,6'), { eye: [1, 2, 3], target: [0, 5, 6] });
});
