// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Box3, Group, Vector3 } from 'three';
import { footprintOf } from '../src/scene/contact_shadow';

const box = new Box3(new Vector3(-0.1, -0.05, 0), new Vector3(0.1, 0.05, 0.2));

test('a turned body has its own rectangle as footprint', () => {
  const solid = new Group();
  solid.position.set(0.4, 0.2, 0.7);
  solid.rotation.z = 0.5;
  const { center, heading, half, bottom } = footprintOf(box, { solid });
  assert.ok(Math.abs(heading - 0.5) < 1e-9);
  assert.ok(Math.abs(half.x - 0.1) < 1e-9 && Math.abs(half.y - 0.05) < 1e-9);
  assert.ok(Math.abs(center.x - 0.4) < 1e-9 && Math.abs(center.y - 0.2) < 1e-9);
  assert.ok(Math.abs(bottom - 0.7) < 1e-9);
});

test('a body that lies on its side has the footprint of that side', () => {
  const solid = new Group();
  solid.rotation.y = Math.PI / 2; // its x axis points down
  const { half, bottom } = footprintOf(box, { solid });
  assert.ok(Math.abs(half.x * half.y - 0.1 * 0.05) < 1e-9);
  assert.ok(Math.abs(bottom + 0.1) < 1e-9);
});
