// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { Quaternion, Vector3 } from 'three';
import type { Hand } from '../src/vr/hands';
import { type ButtonState, labelOf, panelButtons } from '../src/vr/panel_buttons';
import { Person } from '../src/vr/person';
import { Placing } from '../src/vr/placing';
import { timeSlider } from '../src/vr/time_slider';

const up = new Vector3(0, 1, 0);
const rounding = 1e-9; // [m]

function grip(position: Vector3, heading: number, isClutchHeld = true): Hand[] {
  const rotation = new Quaternion().setFromAxisAngle(up, heading);
  return [{ side: 'left', position, rotation, isClutchHeld } as Hand];
}

test('a gripped scene follows the hand and its turns, and stays upright', () => {
  const person = new Person();
  person.standAt(new Vector3(1, 2, -0.75), 0.3, new Vector3(0, 1.6, 0));
  const placing = new Placing(person);
  placing.toggle();
  const from = new Vector3(-0.2, 1.1, -0.4);
  const to = new Vector3(0.1, 0.9, -0.6);
  placing.update(grip(from, 0.2));
  const point = person.toBase(from);
  // A point of the scene 1 m to the right of the hand.
  const side = person.toBase(from.clone().add(new Vector3(1, 0, 0)));
  // Over the turn of pi.
  for (const heading of [1.5, 3, 4.5, 0.7]) placing.update(grip(to, heading));
  assert.ok(person.toHeadset(point).distanceTo(to) < rounding);
  const turned = person.toHeadset(side).sub(to);
  const expected = new Vector3(1, 0, 0).applyAxisAngle(up, 0.5);
  assert.ok(turned.distanceTo(expected) < rounding, `${turned.toArray()}`);
});

test('a hand that lets go, or that does not place, leaves the scene', () => {
  const person = new Person();
  const placing = new Placing(person);
  const before = person.toBase(new Vector3());
  placing.update(grip(new Vector3(0, 1, 0), 0));
  placing.update(grip(new Vector3(1, 1, 0), 0));
  placing.toggle();
  placing.update(grip(new Vector3(0, 1, 0), 0));
  placing.update(grip(new Vector3(1, 1, 0), 0, false));
  placing.update(grip(new Vector3(2, 1, 0), 0));
  assert.ok(person.toBase(new Vector3()).distanceTo(before) < rounding);
});

const live: ButtonState = {
  isOnHold: false,
  isScanShown: true,
  canTake: false,
  hasAsked: false,
  isToolWanted: false,
  canUndoReset: false,
  timeScale: 1,
  isPassthrough: false,
  isPlacing: false,
  playback: null,
};

test('in a replay the buttons of the world are those of the player', () => {
  const playback = {
    time: 1,
    duration: 4,
    isPlaying: true,
    speed: 2,
    toggle: () => {},
    seek: () => {},
    nextSpeed: () => {},
  };
  const texts = (state: ButtonState) => panelButtons.map((b) => labelOf(b, state, false).text);
  assert.deepEqual(texts({ ...live, playback }), [
    ...['PAUSE', '-1 S', '+1 S', 'SCALE', 'RECENTRE', 'NO SCAN', 'TURN', 'SPEED 2'],
    ...['', 'LEAVE', '', ''], // no time scale, nothing to place, nobody asks
  ]);
  assert.deepEqual(texts({ ...live, isPassthrough: true }).slice(-2), ['PLACE', '']);
});

test('after a reset the button undoes it, until a body is touched', () => {
  const text = (state: Partial<ButtonState>) => labelOf('reset', { ...live, ...state }, false).text;
  assert.equal(text({}), 'RESET');
  assert.equal(text({ canUndoReset: true }), 'UNDO');
});

test('the tool of another page is asked for, one that another page asks for is given or kept', () => {
  const texts = (state: Partial<ButtonState>) =>
    (['take', 'keep'] as const).map((b) => labelOf(b, { ...live, ...state }, false).text);
  assert.deepEqual(texts({}), ['TAKE', '']);
  assert.deepEqual(texts({ canTake: true }), ['ASK', '']);
  assert.deepEqual(texts({ canTake: true, hasAsked: true }), ['ASKED', '']);
  assert.deepEqual(texts({ isToolWanted: true }), ['GIVE', 'KEEP']);
});

test('a place on the bar is a time, clamped at its ends', () => {
  for (const time of [0, 1.25, 4]) {
    const { x, y } = timeSlider.placeOf(time, 4);
    assert.ok(Math.abs(timeSlider.timeAt(x, y, 4)! - time) < 1e-12);
  }
  const { x, y } = timeSlider.placeOf(4, 4);
  assert.equal(timeSlider.timeAt(x + 10, y, 4), 4);
  assert.equal(timeSlider.timeAt(x + 20, y, 4), undefined);
  assert.equal(timeSlider.timeAt(x, y + 40, 4), undefined);
  assert.equal(timeSlider.placeOf(0, 0).x, timeSlider.placeOf(0, 4).x);
});
