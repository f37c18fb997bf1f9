// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { LinkInfo } from '../src/link_protocol';
import type { LiveState, ObjectState } from '../src/protocol';
import { Measured } from '../src/session/measured';
import { comparisonRows } from '../src/ui/objects_panel';

const lead = 0.25; // [s]
const back = 0.2; // [s] from the robot's sensor to the page
const frameAge = 0.03; // [s] of the tracked pose, at the robot
const speed = 0.1; // [m/s] along x

/// The world at time t, in which the robot's object is `off` [m] behind the prediction of its instant.
function stateAt(t: number, off: number, corrections = 0, jump = 0): LiveState {
  const object = { position: [speed * t + jump, 0, 0], speed } as unknown as ObjectState;
  const instant = t - lead - back - frameAge;
  const link = {
    lead,
    stamps: { sensed: t - back },
    robot: {
      corrections,
      objects: [{ position: [speed * instant - off, 0, 0], age: frameAge, isTracked: true }],
    },
  } as unknown as LinkInfo;
  return { clock: t, worldTime: t, objects: [object], link } as unknown as LiveState;
}

test('a tracked pose is compared with what was predicted for its instant', () => {
  const measured = new Measured();
  for (let t = 1; t < 3; t += 0.01) measured.add(stateAt(t, 0.002));
  const compared = measured.compare(stateAt(3, 0.002), 0)!;
  assert.ok(Math.abs(compared.error - 0.002) < 1e-9, `${compared.error}`);
  assert.ok(Math.abs(compared.age - (back + frameAge)) < 1e-9, `${compared.age}`);
  assert.ok(Number.isNaN(compared.shift));
});

test('what a correction changed is what the object did not move at its speed', () => {
  const measured = new Measured();
  for (let t = 1; t < 2; t += 0.01) measured.add(stateAt(t, 0));
  measured.add(stateAt(2, 0, 1, 0.005));
  const compared = measured.compare(stateAt(2, 0, 1, 0.005), 0)!;
  assert.ok(Math.abs(compared.shift - 0.005) < 1e-6, `${compared.shift}`);
  assert.equal(compared.shiftAge, 0);
});

test('nothing is stated of what is not tracked, or was not predicted yet', () => {
  const measured = new Measured();
  const state = stateAt(1, 0);
  measured.add(state);
  assert.ok(Number.isNaN(measured.compare(state, 0)!.error));
  state.link!.robot!.objects[0].isTracked = false;
  assert.equal(measured.compare(state, 0), null);
  assert.deepEqual(comparisonRows(null), []);
});
