// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Playout } from '../src/session/playout';

const step = 0.008; // [s] of the hand's samples
const look = 0.004; // [s]

/// The samples of a hand, which arrive at the end of each frame of `frame(t)` seconds; where and when
/// they are played.
function played(frame: (t: number) => number, seconds: number) {
  const playout = new Playout<number>();
  const result: { clock: number; sample: number; at: number }[] = [];
  let nextFrame = 0;
  let sent = 0;
  for (let now = 0; now < seconds; now += look) {
    if (now >= nextFrame) {
      for (; sent * step <= now; ++sent) playout.add(now, sent * step, sent * step);
      nextFrame = now + frame(now);
    }
    for (const one of playout.take(now)) result.push({ ...one, at: now });
  }
  return { result, delay: playout.delay };
}

test('samples that come in time are played at once', () => {
  const { result, delay } = played(() => 0.004, 2);
  assert.equal(delay, 0);
  assert.ok(result.every(({ at, sample }) => at - sample < 0.012));
});

test('samples of a window that draws twice a second are played evenly, half a second late', () => {
  const { result, delay } = played(() => 0.5, 6);
  assert.ok(delay > 0.45 && delay < 0.55, String(delay));
  const late = result.filter(({ at }) => at > 2);
  for (let i = 1; i < late.length; ++i) {
    assert.ok(Math.abs(late[i]!.sample - late[i - 1]!.sample - step) < 1e-9); // none is left out
    assert.ok(late[i]!.at - late[i - 1]!.at <= 3 * look + 1e-9);
    assert.ok(Math.abs(late[i]!.clock - late[i - 1]!.clock - step) < 1e-9);
  }
});

test('after one slow frame the delay goes back to none, and the hand no faster than a tenth', () => {
  const { result, delay } = played((t) => (t < 0.9 || t > 1.1 ? look : 0.4), 9);
  assert.equal(delay, 0);
  for (let i = 1; i < result.length; ++i) {
    assert.ok(result[i]!.clock > result[i - 1]!.clock);
    const speed = step / (result[i]!.clock - result[i - 1]!.clock);
    assert.ok(speed < 1.12, String(speed));
  }
});

test('a window that hung for long does not delay what it sends afterwards', () => {
  const playout = new Playout<number>();
  playout.add(10, 8, 1);
  assert.deepEqual(playout.take(10), [{ clock: 8, sample: 1 }]);
  assert.equal(playout.delay, 0);
});

test('what is forgotten is not played', () => {
  const playout = new Playout<number>();
  playout.add(1, 0.5, 1);
  playout.add(1, 1, 2);
  assert.equal(playout.take(1).length, 0);
  assert.equal(playout.take(1.02).length, 1);
  playout.clear();
  assert.equal(playout.take(2).length, 0);
});
