// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { LiveState } from '../src/protocol';
import { ClockOffset } from '../src/session/clock_offset';
import { Latency, median, SlidingWindow } from '../src/session/latency';
import { looksDifferent } from '../src/session/state_change';

function stateAt(clock: number, toolClock: number): LiveState {
  const age = { tool: 0.001, state: 0, queue: 0 };
  return { clock, toolClock, age } as LiveState;
}

const close = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test('the median of an even number of values is the mean of the middle two', () => {
  assert.equal(median([4, 1, 3, 2]), 2.5);
  assert.equal(median([5]), 5);
  assert.ok(Number.isNaN(median([])));
});

test('a sliding window drops values by age, not by count', () => {
  const values = new SlidingWindow(1);
  for (let i = 0; i < 100; ++i) values.add(i / 10, i);
  assert.deepEqual(values.at(9.9).length, 11);
  assert.deepEqual(values.at(20), []);
});

test('the age of a state is measured on the server clock', () => {
  const latency = new Latency();
  assert.ok(Number.isNaN(latency.age(0)));
  latency.recordReceived(stateAt(1000, NaN), 10.004, 990);
  close(latency.age(10.01), 0.01);
  close(latency.stats(10.01).worldToPage, 0.004);
});

test('the lag of a state is its age beyond the minimum transit time', () => {
  const latency = new Latency();
  assert.ok(Number.isNaN(latency.lag(0)));
  latency.recordReceived(stateAt(0, NaN), 0.02, 0); // a network of 20 ms
  latency.recordReceived(stateAt(1, NaN), 1.09, 0); // delayed
  close(latency.lag(1.1), 0.08);
  latency.recordReceived(stateAt(1.09, NaN), 1.11, 0);
  close(latency.lag(1.11), 0);
});

test('a command counts once, when its effect is first drawn', () => {
  const latency = new Latency();
  for (const [toolClock, drawn] of [
    [1.0, 1.02],
    [1.0, 1.05],
    [1.04, 1.07],
    [NaN, 1.08],
  ]) {
    latency.recordReceived(stateAt(0, toolClock), drawn, 0);
    latency.recordDrawn(stateAt(0, toolClock), drawn);
  }
  close(latency.stats(1.1).commandToDrawn, 0.025);
});

test('the latency stages of a command add up to the total', () => {
  const latency = new Latency();
  // Sent at 1.000 on the page's clock, 51.000 on the server's; used and sent on at 51.006; received
  // at 1.008, drawn at 1.020.
  latency.recordReceived(stateAt(51.006, 1), 1.008, 50);
  latency.recordDrawn(stateAt(51.006, 1), 1.02);
  const stats = latency.stats(1.1);
  close(stats.commandToWorld, 0.006);
  close(stats.worldToPage, 0.002);
  close(stats.pageToDrawn, 0.012);
  close(stats.commandToDrawn, 0.02);
});

test('latency statistics without a state are NaN', () => {
  const stats = new Latency().stats(0);
  assert.equal(stats.stateRate, 0);
  assert.ok(Number.isNaN(stats.commandToDrawn));
  assert.ok(Number.isNaN(stats.maxDrawnAge));
});

test('the ping with the shortest round trip gives the clock offset', () => {
  const offset = new ClockOffset();
  assert.ok(Number.isNaN(offset.seconds()));
  offset.add(1, 1.2, 51.15); // slow, and asymmetric
  offset.add(2, 2.01, 52.005);
  offset.add(3, 3.5, 53.4);
  close(offset.seconds(), 50);
});

test('a clock step is followed once the old pings have left the window', () => {
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

test('a state at rest looks like the previous one, a moved one does not', () => {
  const moved = (x: number) => ({
    ...still,
    objects: [{ ...still.objects[0], position: [x, 0, 0] }],
  });
  assert.equal(looksDifferent(still, moved(1e-7) as LiveState), false);
  assert.equal(looksDifferent(still, moved(1e-4) as LiveState), true);
  assert.equal(looksDifferent(still, moved(NaN) as LiveState), true);
  assert.equal(looksDifferent(still, { ...still, pulses: 1 }), true);
  assert.equal(looksDifferent(still, { ...still, timeScale: 0.5 }), true);
  assert.equal(looksDifferent(still, { ...still, isEngaged: true }), true);
  assert.equal(looksDifferent(still, { ...still, objects: [] }), true);
});
