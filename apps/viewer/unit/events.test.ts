// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { eventBeside, eventsOf } from '../src/replay/events';
import { Table, type Replay, type ReplayObject } from '../src/replay/replay_data';
import { touchedAt } from '../src/replay/touched';

const phases = [
  { t: 1, measured: 'static', predicted: 'free' },
  { t: 1.5, measured: 'critical', predicted: 'static' },
  { t: 2, measured: 'sliding', predicted: 'static' },
  { t: 3, measured: 'free', predicted: 'free' },
  { t: 4, measured: 'sliding', predicted: 'free' },
];
const corrections = [{ t: 2.5, object: 'a', case: 1, what: 'pose+lost', bytes: 60 }];
const replay = { model: { corrections }, objects: [{ name: 'a', phases }] } as unknown as Replay;

test('events are contacts, breakaways and corrections, by time', () => {
  assert.deepEqual(
    eventsOf(replay).map(({ time, text }) => `${time} ${text}`),
    [
      '1 contact with a',
      '2 breakaway of a',
      '2.5 correction of a, lost',
      '4 contact with a',
      '4 breakaway of a',
    ],
  );
});

test('without a measured force the predicted phases count', () => {
  const predicted = phases.map((phase) => ({ ...phase, measured: 'free' }));
  const only = {
    ...replay,
    model: { corrections: [] },
    objects: [{ name: 'a', phases: predicted }],
  };
  assert.deepEqual(
    eventsOf(only as unknown as Replay).map(({ time }) => time),
    [1.5],
  );
});

test('a jump goes on from an event to the next one, and back', () => {
  const events = eventsOf(replay);
  const times = (direction: 1 | -1, from: number) => {
    const visited: number[] = [];
    for (let at = eventBeside(events, from, direction); at;) {
      visited.push(at.time);
      at = eventBeside(events, at.time, direction);
    }
    return visited;
  };
  assert.deepEqual(times(1, 0), [1, 2, 2.5, 4]);
  assert.deepEqual(times(-1, 9), [4, 2.5, 2, 1]);
});

const touching = (name: string, ...rows: number[][]) =>
  ({
    name,
    phases: [],
    force: new Table(Float32Array.from(rows.flat()), 3),
  }) as unknown as ReplayObject;

test('the touched object is the one pushed hardest, then the last one, then the first to come', () => {
  const objects = [
    touching('never'),
    touching('a', [2, 6, 6], [4, 6, 6], [4, NaN, NaN], [20, 1, 1]),
    touching('b', [1, 1, 1], [3, 9, 9], [3, NaN, NaN], [9, 1, 1], [10, 1, 1]),
  ];
  const at = (time: number) => touchedAt(objects, time)?.name;
  assert.deepEqual([0, 1.5, 2.1, 2.9, 3.5, 6, 9.5, 15].map(at), [
    'b',
    'b',
    'a',
    'b',
    'a',
    'a',
    'b',
    'b',
  ]);
  assert.equal(touchedAt([], 1), undefined);
  const contact = { ...objects[0], phases: [{ t: 6, measured: 'static', predicted: 'free' }] };
  const touched = touchedAt([...objects, contact as ReplayObject], 6);
  assert.equal(touched, contact, 'by its phase before the first force');
});
