// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { Quaternion, Vector3 } from 'three';
import { clearPlace, hides, isInView } from '../src/vr/clear_view';
import { Clutch } from '../src/vr/clutch';
import { nextScale } from '../src/vr/locomotion';
import { Person } from '../src/vr/person';
import { Pulses } from '../src/vr/pulses';
import { signText } from '../src/vr/sign';
import type { Vector } from '../src/protocol';
import { directionInView } from '../src/vr/robot_arrow';
import { floorHeight, floorLevel, startPose } from '../src/vr/start';
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
  const nothing = { objects: [], cameras: [] };
  const supports = [{ z: 0.02, outline: null }];
  assert.equal(floorHeight({ supports, scanMinZ: -0.7, ...nothing }), -0.7);
  assert.equal(floorHeight({ supports, scanMinZ: -0.05, ...nothing }), 0.02 - 0.75);
  assert.equal(floorHeight({ supports: [], scanMinZ: undefined, ...nothing }), -0.75);
});

const degree = Math.PI / 180;

/// The angles of a point below the horizon and to the side of an eye at a start pose [rad].
function anglesTo(point: Vector3, foot: Vector3, heading: number, eyeHeight: number) {
  const from = point
    .clone()
    .sub(foot)
    .sub(new Vector3(0, 0, eyeHeight));
  const ahead = Math.cos(heading) * from.x + Math.sin(heading) * from.y;
  const aside = Math.cos(heading) * from.y - Math.sin(heading) * from.x;
  assert.ok(ahead > 0, 'in front');
  return { down: Math.atan2(-from.z, Math.hypot(ahead, aside)), aside: Math.atan2(aside, ahead) };
}

test('from the start a head pitched 20 degrees down has all objects in view', () => {
  const objects = [new Vector3(0.5, 0.3, 0.1), new Vector3(0.7, -0.3, 0.05)];
  const supports = [{ z: 0, outline: null }];
  for (const eyeHeight of [1.1, 1.6, 1.9]) {
    const ground = { supports, scanMinZ: undefined, objects, cameras: [] };
    const { foot, heading } = startPose(ground, eyeHeight);
    for (const object of objects) {
      const { down, aside } = anglesTo(object, foot, heading, eyeHeight);
      // A headset shows at least 40 degrees to each side of the middle.
      assert.ok(Math.abs(down - 20 * degree) < 25 * degree, `${down / degree} degrees down`);
      assert.ok(Math.abs(aside) < 35 * degree, `${aside / degree} degrees aside`);
    }
  }
});

test('the user starts at the side of the robot, or where the cameras were', () => {
  const objects = [new Vector3(0, 0.8, 0)];
  const ground = { supports: [], scanMinZ: 0, objects, cameras: [] };
  const atRobot = startPose(ground, 1.6);
  assert.ok(Math.abs(atRobot.heading - Math.PI / 2) < rounding);
  assert.ok(Math.abs(atRobot.foot.x) < rounding && atRobot.foot.y < 0.8 - 0.45 + rounding);
  assert.equal(atRobot.foot.z, 0);
  const atCameras = startPose({ ...ground, cameras: [[0, 2, 1]] }, 1.6);
  assert.ok(Math.abs(Math.abs(atCameras.heading) - Math.PI / 2) < rounding);
  assert.ok(atCameras.foot.y > 0.8 + 0.45 - rounding);
});

test('a robot beside or behind the user is pointed at, one in view is not', () => {
  const head = new Vector3(0, 1.6, 0);
  const ahead = new Quaternion();
  assert.equal(directionInView(new Vector3(0.2, 1, -1.5), head, ahead), null);
  const right = directionInView(new Vector3(3, 1.6, 0), head, ahead)!;
  assert.ok(Math.abs(right) < rounding, `${right}`);
  const left = directionInView(new Vector3(-3, 1.6, 1), head, ahead)!;
  assert.ok(Math.abs(Math.abs(left) - Math.PI) < rounding, `${left}`);
  const below = directionInView(new Vector3(0, 0, -0.1), head, ahead)!;
  assert.ok(Math.abs(below + Math.PI / 2) < rounding, `${below}`);
  const turned = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), -Math.PI / 2);
  assert.equal(directionInView(new Vector3(3, 1.6, 0), head, turned), null);
});

test('a teleport stays within a few steps of the scene', () => {
  const objects = [new Vector3(0.6, 0.2, 0)];
  const ground = { supports: [], scanMinZ: -0.7, objects, cameras: [[-1, 0, 1] as Vector] };
  const floor = floorLevel(ground);
  assert.equal(floor.z, -0.7);
  const landingAt = (x: number) =>
    findLanding([new Vector3(x, 0, 1), new Vector3(x, 0, -1)], [floor])?.point;
  near(landingAt(2.5)!, new Vector3(2.5, 0, -0.7));
  near(landingAt(-2.9)!, new Vector3(-2.9, 0, -0.7));
  assert.equal(landingAt(2.7), undefined);
  assert.equal(landingAt(-3.1), undefined);
});

test('a sheet stays at the hand, and moves only where it would hide a body', () => {
  const eye = new Vector3(0, 1.6, 0);
  const place = new Vector3(-0.1, 1.4, -0.4);
  const size = { width: 0.16, height: 0.2 };
  const gaze = { head: eye, forward: new Vector3(0, -0.3, -1).normalize() };
  near(clearPlace(place, size, gaze, [], -1), place);
  const far = { center: new Vector3(1, 1, -1), radius: 0.1 };
  near(clearPlace(place, size, gaze, [far], -1), place);
  const behind = { center: place.clone().sub(eye).multiplyScalar(3).add(eye), radius: 0.15 };
  assert.ok(hides(place, size, eye, behind));
  const clear = clearPlace(place, size, gaze, [behind], -1);
  assert.ok(!hides(clear, size, eye, behind));
  assert.ok(clear.distanceTo(place) > 0.05 && clear.distanceTo(place) < 0.4);
});

test('a sheet that has to move stays in the view of both eyes', () => {
  const eye = new Vector3(0, 1.6, 0);
  const gaze = { head: eye, forward: new Vector3(0, -0.35, -1).normalize() };
  const size = { width: 0.16, height: 0.24 };
  const place = new Vector3(-0.2, 1.4, -0.4);
  assert.ok(isInView(place, size, gaze));
  const body = { center: new Vector3(-0.3, 0.8, -1.2), radius: 0.15 };
  assert.ok(hides(place, size, eye, body));
  const clear = clearPlace(place, size, gaze, [body], -1);
  assert.ok(!hides(clear, size, eye, body));
  assert.ok(isInView(clear, size, gaze), `${clear.toArray()}`);
  const atTheEdge = new Vector3(-0.3, 1.4, -0.4);
  assert.ok(!isInView(atTheEdge, size, gaze));
  assert.ok(isInView(clearPlace(atTheEdge, size, gaze, [], -1), size, gaze));
  const outOfView = new Vector3(-0.5, 1.2, 0.1);
  near(clearPlace(outOfView, size, gaze, [], -1), outOfView);
});

test('a high, narrow sheet hides what is above and below its middle, not what is beside it', () => {
  const eye = new Vector3(0, 1.6, 0);
  const place = new Vector3(0, 1.6, -0.5);
  const size = { width: 0.16, height: 0.3 };
  const at = (x: number, y: number, z: number) => ({
    center: new Vector3(x, y, z).add(eye),
    radius: 0.1,
  });
  assert.ok(hides(place, size, eye, at(0, 0.35, -1.5)));
  assert.ok(hides(place, size, eye, at(0.3, 0, -1.5)));
  assert.ok(!hides(place, size, eye, at(0.42, 0, -1.5)));
  assert.ok(!hides(place, size, eye, at(0, 0.65, -1.5)));
  assert.ok(!hides(place, size, eye, at(0, 0, 1.5)), 'behind the head');
});

test('a sign names the most urgent trouble', () => {
  const well = {
    isLost: false,
    isSlow: false,
    isOutsideModel: false,
    isRefused: false,
    isOnHold: false,
  };
  assert.equal(signText(well), null);
  assert.equal(signText({ ...well, isOnHold: true })?.[0], 'PAUSED');
  assert.equal(signText({ ...well, isOnHold: true, isRefused: true })?.[0], 'TOOL IN USE');
  assert.equal(
    signText({ ...well, isRefused: true, isOutsideModel: true })?.[0],
    'OUTSIDE THE MODEL',
  );
  assert.equal(signText({ ...well, isOutsideModel: true, isLost: true })?.[0], 'CONNECTION LOST');
  assert.equal(signText({ ...well, isSlow: true })?.[0], 'SLOW PICTURE');
  assert.equal(signText({ ...well, isSlow: true, isLost: true })?.[0], 'CONNECTION LOST');
});

test('the scale goes up and wraps around', () => {
  assert.deepEqual([0.5, 1, 2, 4].map(nextScale), [1, 2, 4, 0.5]);
});
