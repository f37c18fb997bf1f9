// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { LiveState } from '../src/protocol';
import { ClockOffset } from '../src/session/clock_offset';
import { Latency, median, RecentValues } from '../src/session/latency';
import { looksDifferent } from '../src/session/state_change';

function stateAt(clock: number, toolClock: number): LiveState {
  const age = { tool: 0.001, state: 0, queue: 0 };
  return { clock, toolClock, age } as LiveState;
}

const close = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test('the median of an even number is between the two in the middle', () => {
  assert.equal(median([4, 1, 3, 2]), 2.5);
  assert.equal(median([5]), 5);
  assert.ok(Number.isNaN(median([])));
});

test('recent values are forgotten with time, not with number', () => {
  const values = new RecentValues(1);
  for (let i = 0; i < 100; ++i) values.add(i / 10, i);
  assert.deepEqual(values.at(9.9).length, 11);
  assert.deepEqual(values.at(20), []);
});

test('the age of a state counts on the clock of the server', () => {
  const latency = new Latency();
  assert.ok(Number.isNaN(latency.age(0)));
  latency.received(stateAt(1000, NaN), 10.004, 990);
  close(latency.age(10.01), 0.01);
  close(latency.figures(10.01).worldToPage, 0.004);
});

test('a state lags by what it is older than one that just came', () => {
  const latency = new Latency();
  assert.ok(Number.isNaN(latency.lag(0)));
  latency.received(stateAt(0, NaN), 0.02, 0); // a network of 20 ms
  latency.received(stateAt(1, NaN), 1.09, 0); // held up
  close(latency.lag(1.1), 0.08);
  latency.received(stateAt(1.09, NaN), 1.11, 0);
  close(latency.lag(1.11), 0);
});

test('a command counts once, when its effect is drawn first', () => {
  const latency = new Latency();
  for (const [toolClock, drawn] of [
    [1.0, 1.02],
    [1.0, 1.05],
    [1.04, 1.07],
    [NaN, 1.08],
  ]) {
    latency.received(stateAt(0, toolClock), drawn, 0);
    latency.drawn(stateAt(0, toolClock), drawn);
  }
  close(latency.figures(1.1).commandToDrawn, 0.025);
});

test('the stages of a command add up to its way', () => {
  const latency = new Latency();
  // Sent at 1.000 of the page, which is 51.000 of the server; used and sent on at 51.006; here at
  // 1.008, drawn at 1.020.
  latency.received(stateAt(51.006, 1), 1.008, 50);
  latency.drawn(stateAt(51.006, 1), 1.02);
  const figures = latency.figures(1.1);
  close(figures.commandToWorld, 0.006);
  close(figures.worldToPage, 0.002);
  close(figures.pageToPicture, 0.012);
  close(figures.commandToDrawn, 0.02);
});

test('figures without a state are no numbers', () => {
  const figures = new Latency().figures(0);
  assert.equal(figures.stateRate, 0);
  assert.ok(Number.isNaN(figures.commandToDrawn));
  assert.ok(Number.isNaN(figures.oldestDrawn));
});

test('the quickest ping tells the offset of the clocks', () => {
  const offset = new ClockOffset();
  assert.ok(Number.isNaN(offset.seconds()));
  offset.add(1, 1.2, 51.15); // slow, and slower on the way there
  offset.add(2, 2.01, 52.005);
  offset.add(3, 3.5, 53.4);
  close(offset.seconds(), 50);
});

test('a clock that runs away is followed once its old pings are forgotten', () => {
  const offset = new ClockOffset();
  offset.add(0, 0.001, 50);
  for (let i = 1; i <= 16; ++i) offset.add(i, i + 0.002, 60 + i + 0.001);
  close(offset.seconds(), 60);
});

const still = {
  hip: [0, 0, 0],
  proxy: [0, 0, 0],
  force: [0, 0, 0],
  pulses: 0,
  isEngaged: false,
  objects: [{ position: [0, 0, 0], quaternion: [0, 0, 0, 1], phase: 'free' }],
} as unknown as LiveState;

test('a state at rest looks like the one before, a moved one does not', () => {
  const moved = (x: number) => ({
    ...still,
    objects: [{ ...still.objects[0], position: [x, 0, 0] }],
  });
  assert.equal(looksDifferent(still, moved(1e-7) as LiveState), false);
  assert.equal(looksDifferent(still, moved(1e-4) as LiveState), true);
  assert.equal(looksDifferent(still, moved(NaN) as LiveState), true);
  assert.equal(looksDifferent(still, { ...still, pulses: 1 }), true);
  assert.equal(looksDifferent(still, { ...still, isEngaged: true }), true);
  assert.equal(looksDifferent(still, { ...still, objects: [] }), true);
});
