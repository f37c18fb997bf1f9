// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Vector3 } from 'three';
import { framePoints, operatorSide } from '../src/scene/first_view';
import type { Vector } from '../src/protocol';

const center: Vector = [0.6, 0, 0.1];

function near(a: Vector3, b: Vector3): void {
  assert.ok(a.distanceTo(b) < 1e-9, `${a.toArray()} is not ${b.toArray()}`);
}

test('the operator stands at the robot where nothing is known of the cameras', () => {
  near(operatorSide(center, []), new Vector3(-1, 0, 0));
  near(operatorSide([0, 0, 0.1], []), new Vector3(-1, 0, 0));
});

test('the operator stands at the robot if a quarter of the cameras did', () => {
  const opposite: Vector[] = [1, 2, 3].map((i) => [2, 0.1 * i, 1]);
  near(operatorSide(center, [...opposite, [-0.5, 0, 1]]), new Vector3(-1, 0, 0));
});

test('the operator stands where most cameras did if few were at the robot', () => {
  const aside: Vector[] = [
    [0.6, 1, 1],
    [0.6, 2, 1],
    [0.7, 1, 1],
    [0.5, 1, 1],
  ];
  const side = operatorSide(center, [...aside, [-0.5, 0, 1]]);
  assert.ok(side.angleTo(new Vector3(0, 1, 0)) < 0.05, `${side.toArray()}`);
  assert.ok(Math.abs(side.length() - 1) < 1e-12);
});

test('a camera above the middle has no side', () => {
  near(operatorSide(center, [[0.6, 0, 2]]), new Vector3(-1, 0, 0));
});

test('framed points fill the picture in one direction, and are in its middle in the other', () => {
  const points = [-1, 1].flatMap((x) => [-2, 0.5].map((z) => new Vector3(x, 0.2 * z, z)));
  points.push(new Vector3(0, 0.7, 0));
  const back = new Vector3(0, 0.6, 0.8);
  for (const tangents of [
    { right: 0.2, up: 0.5 },
    { right: 1.2, up: 0.4 },
  ]) {
    const { eye, target } = framePoints(points, back, tangents);
    near(eye.clone().sub(target).normalize(), back);
    const up = back.clone().cross(new Vector3(1, 0, 0));
    const seen = points.map((point) => {
      const from = point.clone().sub(eye);
      const depth = -from.dot(back);
      assert.ok(depth > 0);
      return [from.x / depth / tangents.right, from.dot(up) / depth / tangents.up];
    });
    const reach = [0, 1].map((axis) => {
      const values = seen.map((at) => at[axis]);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      assert.ok(Math.abs(low + high) < 1e-6, `axis ${axis} reaches from ${low} to ${high}`);
      return high;
    });
    assert.ok(Math.abs(Math.max(...reach) - 1) < 1e-6, `${reach}`);
  }
});
