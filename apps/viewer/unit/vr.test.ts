// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { Quaternion, Vector3 } from 'three';
import { Clutch } from '../src/vr/clutch';
import { nextScale } from '../src/vr/locomotion';
import { Person } from '../src/vr/person';
import { Pulses } from '../src/vr/pulses';
import { floorHeight, startPose } from '../src/vr/start';
import { ballisticPath, findLanding } from '../src/vr/teleport';

const head = new Vector3(0.3, 1.6, -0.2);
const rounding = 1e-12; // [m] of a few products of numbers near 1

function near(a: Vector3, b: Vector3, tolerance = rounding): void {
  assert.ok(a.distanceTo(b) <= tolerance, `${a.toArray()} is not ${b.toArray()}`);
}

test('the user stands with the head above the foot point, z up, facing along the heading', () => {
  const person = new Person();
  person.standAt(new Vector3(1, 2, -0.75), Math.PI / 2, head);
  near(person.toBase(head), new Vector3(1, 2, 0.85));
  const forward = head.clone().add(new Vector3(0, 0, -1));
  near(person.toBase(forward), new Vector3(1, 3, 0.85));
});

test('a turn keeps the position of the head', () => {
  const person = new Person();
  person.standAt(new Vector3(), 0, head);
  const before = person.toBase(head);
  person.turnBy(Math.PI / 6, head);
  near(person.toBase(head), before);
  const forward = person.toBase(head.clone().add(new Vector3(0, 0, -1))).sub(before);
  near(forward, new Vector3(Math.cos(Math.PI / 6), Math.sin(Math.PI / 6), 0));
});

test('a scale keeps its pivot, and scales down the motion of a hand', () => {
  const person = new Person();
  person.standAt(new Vector3(), 0.4, head);
  const hand = new Vector3(0.2, 1.1, -0.4);
  const before = person.toBase(hand);
  person.scaleTo(4, hand);
  near(person.toBase(hand), before);
  const moved = person.toBase(hand.clone().add(new Vector3(0.08, 0, 0))).sub(before);
  assert.ok(Math.abs(moved.length() - 0.02) < rounding);
});

test('a teleport keeps the height over the scene, the heading and the scale', () => {
  const person = new Person();
  person.standAt(new Vector3(0, 0, -0.75), 0.4, head);
  person.scaleTo(2, head);
  const height = person.toBase(head).z;
  const turn = person.rotationToBase(new Quaternion());
  person.goTo(new Vector3(1.5, -0.5, 0), head);
  near(person.toBase(head), new Vector3(1.5, -0.5, height));
  assert.ok(person.rotationToBase(new Quaternion()).angleTo(turn) < 1e-7);
  assert.equal(person.scale, 2);
});

test('a clutch is closed while its button is held', () => {
  const clutch = new Clutch();
  assert.equal(clutch.update(false, ''), false);
  assert.equal(clutch.update(true, ''), true);
  assert.equal(clutch.update(false, ''), false);
});

test('a clutch opened by an interlock stays open until the button was released', () => {
  const clutch = new Clutch();
  clutch.update(true, '');
  assert.equal(clutch.update(true, 'on hold'), false);
  assert.equal(clutch.openReason, 'on hold');
  assert.equal(clutch.update(true, ''), false);
  assert.equal(clutch.update(false, ''), false);
  assert.equal(clutch.openReason, '');
  assert.equal(clutch.update(true, ''), true);
});

test('a button already held when tracking starts does not close the clutch', () => {
  const clutch = new Clutch();
  clutch.update(false, 'hand not tracked');
  assert.equal(clutch.update(true, ''), false);
});

test('each event gives one short pulse, which no rumble overrides', () => {
  const given: number[][] = [];
  const actuator = { pulse: (value: number, ms: number) => given.push([value, ms]) };
  const pulses = new Pulses();
  pulses.update(0, { pulse: 0, pulses: 7 }, actuator);
  assert.deepEqual(given, []); // events before the session are not rendered
  pulses.update(14, { pulse: 0.5, pulses: 8 }, actuator);
  pulses.update(28, { pulse: 0.5, pulses: 8 }, actuator);
  assert.deepEqual(given, [[1, 25]]);
  pulses.update(42, { pulse: 0.5, pulses: 8 }, actuator);
  assert.equal(given[1][0], 0.5);
});

test('events without an actuator are dropped, not queued', () => {
  const given: number[] = [];
  const pulses = new Pulses();
  pulses.update(0, { pulse: 0, pulses: 1 }, undefined);
  pulses.update(14, { pulse: 0, pulses: 3 }, undefined);
  pulses.update(28, { pulse: 0, pulses: 3 }, { pulse: (value) => given.push(value) });
  assert.deepEqual(given, []);
});

test('an arc lands where its parabola meets the floor, or on a table above it', () => {
  const path = ballisticPath(new Vector3(0, 0, 1), new Vector3(1, 0, 0), 1);
  const floor = { z: 0, outline: null };
  const reach = 5 * Math.sqrt(2 / 9.81);
  // Straight segments of 50 ms are within 1 mm of the parabola; 5 mm along the floor.
  near(findLanding(path, [floor])!.point, new Vector3(reach, 0, 0), 0.005);
  const outline: [number, number, number][] = [
    [1, -1],
    [3, -1],
    [3, 1],
    [1, 1],
  ].map(([x, y]) => [x, y, 0.5]);
  assert.equal(findLanding(path, [floor, { z: 0.5, outline }])!.point.z, 0.5);
  const offPath = outline.map(([x, y, z]): [number, number, number] => [x, y + 5, z]);
  assert.equal(findLanding(path, [floor, { z: 0.5, outline: offPath }])!.point.z, 0);
});

test('an arc that meets no level has no landing', () => {
  const path = ballisticPath(new Vector3(0, 0, 1), new Vector3(0, 0, 1), 1);
  assert.equal(findLanding(path, [{ z: 30, outline: null }]), undefined);
});

test('the floor is the lowest point of the scan, or a table height below the support', () => {
  const supports = [{ z: 0.02, outline: null }];
  assert.equal(floorHeight({ supports, scanMinZ: -0.7, objects: [] }), -0.7);
  assert.equal(floorHeight({ supports, scanMinZ: -0.05, objects: [] }), 0.02 - 0.75);
  assert.equal(floorHeight({ supports: [], scanMinZ: undefined, objects: [] }), -0.75);
});

test('the user starts at the base, facing the objects, at a minimum distance from them', () => {
  const ground = { supports: [], scanMinZ: 0, objects: [new Vector3(0, 0.8, 0.1)] };
  const far = startPose(ground);
  near(far.foot, new Vector3());
  assert.ok(Math.abs(far.heading - Math.PI / 2) < rounding);
  const close = startPose({ ...ground, objects: [new Vector3(0.1, 0, 0.1)] });
  near(close.foot, new Vector3(0.1 - 0.45, 0, 0));
});

test('the scale goes up and wraps around', () => {
  assert.deepEqual([0.5, 1, 2, 4].map(nextScale), [1, 2, 4, 0.5]);
});
