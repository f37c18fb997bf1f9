// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { Quaternion, Vector3 } from 'three';
import { Clutch } from '../src/vr/clutch';
import { nextScale } from '../src/vr/moving';
import { Person } from '../src/vr/person';
import { Pulses } from '../src/vr/pulses';
import { floorOf, startingPlace } from '../src/vr/start';
import { landing, throwPath } from '../src/vr/teleport';

const head = new Vector3(0.3, 1.6, -0.2);
const rounding = 1e-12; // [m] of a few products of numbers near 1

function near(a: Vector3, b: Vector3, tolerance = rounding): void {
  assert.ok(a.distanceTo(b) <= tolerance, `${a.toArray()} is not ${b.toArray()}`);
}

test('a person stands with the head over the foot, z up, looking along the heading', () => {
  const person = new Person();
  person.standAt(new Vector3(1, 2, -0.75), Math.PI / 2, head);
  near(person.toBase(head), new Vector3(1, 2, 0.85));
  const ahead = head.clone().add(new Vector3(0, 0, -1));
  near(person.toBase(ahead), new Vector3(1, 3, 0.85));
});

test('a turn keeps the head where it is', () => {
  const person = new Person();
  person.standAt(new Vector3(), 0, head);
  const before = person.toBase(head);
  person.turnBy(Math.PI / 6, head);
  near(person.toBase(head), before);
  const ahead = person.toBase(head.clone().add(new Vector3(0, 0, -1))).sub(before);
  near(ahead, new Vector3(Math.cos(Math.PI / 6), Math.sin(Math.PI / 6), 0));
});

test('a scale keeps its pivot, and divides the motion of a hand', () => {
  const person = new Person();
  person.standAt(new Vector3(), 0.4, head);
  const hand = new Vector3(0.2, 1.1, -0.4);
  const before = person.toBase(hand);
  person.scaleTo(4, hand);
  near(person.toBase(hand), before);
  const moved = person.toBase(hand.clone().add(new Vector3(0.08, 0, 0))).sub(before);
  assert.ok(Math.abs(moved.length() - 0.02) < rounding);
});

test('a teleport keeps the height over the scene, and neither turns nor scales', () => {
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

test('a clutch follows the hand that holds it', () => {
  const clutch = new Clutch();
  assert.equal(clutch.update(false, ''), false);
  assert.equal(clutch.update(true, ''), true);
  assert.equal(clutch.update(false, ''), false);
});

test('a clutch that was opened for safety waits until the hand let go', () => {
  const clutch = new Clutch();
  clutch.update(true, '');
  assert.equal(clutch.update(true, 'on hold'), false);
  assert.equal(clutch.openedBecause, 'on hold');
  assert.equal(clutch.update(true, ''), false);
  assert.equal(clutch.update(false, ''), false);
  assert.equal(clutch.openedBecause, '');
  assert.equal(clutch.update(true, ''), true);
});

test('a hand that already holds when it comes into sight takes hold of nothing', () => {
  const clutch = new Clutch();
  clutch.update(false, 'the hand is not seen');
  assert.equal(clutch.update(true, ''), false);
});

test('each event gives one crisp pulse, and no rumble runs over it', () => {
  const given: number[][] = [];
  const actuator = { pulse: (value: number, ms: number) => given.push([value, ms]) };
  const pulses = new Pulses();
  pulses.update(0, { pulse: 0, pulses: 7 }, actuator);
  assert.deepEqual(given, []); // what was before is not felt
  pulses.update(14, { pulse: 0.5, pulses: 8 }, actuator);
  pulses.update(28, { pulse: 0.5, pulses: 8 }, actuator);
  assert.deepEqual(given, [[1, 25]]);
  pulses.update(42, { pulse: 0.5, pulses: 8 }, actuator);
  assert.equal(given[1][0], 0.5);
});

test('events without an actuator are not given later', () => {
  const given: number[] = [];
  const pulses = new Pulses();
  pulses.update(0, { pulse: 0, pulses: 1 }, undefined);
  pulses.update(14, { pulse: 0, pulses: 3 }, undefined);
  pulses.update(28, { pulse: 0, pulses: 3 }, { pulse: (value) => given.push(value) });
  assert.deepEqual(given, []);
});

test('a thrown ball lands where a parabola meets the floor, and on a table before the floor', () => {
  const path = throwPath(new Vector3(0, 0, 1), new Vector3(1, 0, 0), 1);
  const floor = { z: 0, outline: null };
  const reach = 5 * Math.sqrt(2 / 9.81);
  // The path is drawn in straight pieces of 50 ms: within 1 mm of the curve, flat to its slope.
  near(landing(path, [floor])!.place, new Vector3(reach, 0, 0), 0.005);
  const outline: [number, number, number][] = [
    [1, -1],
    [3, -1],
    [3, 1],
    [1, 1],
  ].map(([x, y]) => [x, y, 0.5]);
  assert.equal(landing(path, [floor, { z: 0.5, outline }])!.place.z, 0.5);
  const beside = outline.map(([x, y, z]): [number, number, number] => [x, y + 5, z]);
  assert.equal(landing(path, [floor, { z: 0.5, outline: beside }])!.place.z, 0);
});

test('a throw that meets nothing lands nowhere', () => {
  const path = throwPath(new Vector3(0, 0, 1), new Vector3(0, 0, 1), 1);
  assert.equal(landing(path, [{ z: 30, outline: null }]), undefined);
});

test('the floor is where the scan ends, or a table below what things stand on', () => {
  const supports = [{ z: 0.02, outline: null }];
  assert.equal(floorOf({ supports, lowest: -0.7, things: [] }), -0.7);
  assert.equal(floorOf({ supports, lowest: -0.05, things: [] }), 0.02 - 0.75);
  assert.equal(floorOf({ supports: [], lowest: undefined, things: [] }), -0.75);
});

test('a person begins at the base, faces the things, and does not stand in them', () => {
  const ground = { supports: [], lowest: 0, things: [new Vector3(0, 0.8, 0.1)] };
  const far = startingPlace(ground);
  near(far.foot, new Vector3());
  assert.ok(Math.abs(far.heading - Math.PI / 2) < rounding);
  const close = startingPlace({ ...ground, things: [new Vector3(0.1, 0, 0.1)] });
  near(close.foot, new Vector3(0.1 - 0.45, 0, 0));
});

test('the scale goes up and round', () => {
  assert.deepEqual([0.5, 1, 2, 4].map(nextScale), [1, 2, 4, 0.5]);
});
