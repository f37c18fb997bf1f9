// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Box3, Vector3 } from 'three';
import { Approach, placeBehind } from '../src/input/approach';
import { missText, pushHeight, type Obstacle } from '../src/input/push_height';

const radius = 0.01;

function obstacle(name: string, x: number, y: number, height = 0.1): Obstacle {
  const box = new Box3(new Vector3(x - 0.05, y - 0.05, 0), new Vector3(x + 0.05, y + 0.05, height));
  return { name, box, isMovable: true };
}

const box = obstacle('box', 0.6, 0);

test('a tool above the table beside a body goes to its mid-height', () => {
  assert.equal(pushHeight(new Vector3(0.5, 0, 0.3), radius, [box]), 0.05);
});

test('a tool level with a body, over it, or far from it keeps its height', () => {
  assert.equal(pushHeight(new Vector3(0.5, 0, 0.08), radius, [box]), null);
  assert.equal(pushHeight(new Vector3(0.6, 0, 0.3), radius, [box]), null);
  assert.equal(pushHeight(new Vector3(-0.2, 0, 0.3), radius, [box]), null);
});

test('a tool over another body keeps its height', () => {
  const shelf = { ...obstacle('shelf', 0.48, 0, 0.2), isMovable: false };
  assert.equal(pushHeight(new Vector3(0.5, 0, 0.3), radius, [box, shelf]), null);
});

test('at a flat body the tool stays above the table', () => {
  const sheet = obstacle('sheet', 0.6, 0, 0.004);
  assert.ok(pushHeight(new Vector3(0.5, 0, 0.3), radius, [sheet])! >= radius);
});

test('a miss is explained by the body that was the nearest', () => {
  const far = obstacle('far', 2, 0);
  const text = (x: number, z: number) => missText(new Vector3(x, 0, z), radius, [far, box]);
  assert.match(text(0.6, 0.21), /passes 10 cm above box/);
  assert.match(text(0.6, -0.06), /passes 5 cm below box/);
  assert.match(text(0.51, 0.05), /stops 3 cm before box/);
  assert.equal(missText(new Vector3(), radius, []), '');
});

test('the tool stands behind the pressed point in any direction of the drag', () => {
  for (let angle = 0; angle < 6.3; angle += 0.3) {
    const direction = new Vector3(Math.cos(angle), Math.sin(angle), 0);
    const place = placeBehind(new Vector3(0.58, 0.02, 0.1), direction, radius, box);
    assert.ok(box.box.distanceToPoint(place) > radius, `${angle}`);
    assert.ok(
      place
        .clone()
        .sub(new Vector3(0.58, 0.02, 0))
        .dot(direction) < 0,
      `${angle}`,
    );
    assert.equal(place.z, 0.05);
  }
});

/// Where the tip was on its way.
function walk(from: Vector3, to: Vector3, obstacles: readonly Obstacle[]): Vector3[] {
  const approach = new Approach(from, to, radius, obstacles);
  const tip = from.clone();
  const path: Vector3[] = [];
  for (let i = 0; i < 1000 && !approach.isDone; ++i) {
    approach.update(0.01, tip, tip);
    path.push(tip.clone());
  }
  return path;
}

test('the tool goes straight where nothing is in between, or else over the bodies', () => {
  const to = new Vector3(0.5, 0, 0.05);
  const straight = walk(new Vector3(0.3, 0, 0.05), to, [box]);
  assert.ok(straight.every(({ z }) => Math.abs(z - 0.05) < 1e-9));
  const over = walk(new Vector3(0.7, 0, 0.05), to, [box]);
  assert.ok(over.every((point) => box.box.distanceToPoint(point) > 0.98 * radius));
  for (const path of [straight, over]) assert.ok(path.at(-1)!.distanceTo(to) < 1e-6);
});
