// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  Command,
  Device,
  headerBytes,
  MessageType,
  readHeader,
  readJson,
  readPong,
  readState,
  readVersion,
  writeCommand,
  writeJson,
  writePing,
  writeTool,
  type LiveState,
} from '../src/protocol';
import { linkStages, stageNames } from '../src/ui/link_delays';
import { writePong, writeState } from './server_messages';

// Numbers that a float represents exactly, so that the round trip is exact.
const state: LiveState = {
  clock: 12.5,
  sequence: 7,
  worldTime: 3.25,
  toolClock: 1700000000.125,
  isEngaged: true,
  isOnHold: false,
  isStopped: false,
  timeScale: 0.25,
  touchesScan: true,
  hasTool: false,
  isToolTaken: true,
  canUndoReset: true,
  isToolWanted: true,
  hasAsked: false,
  isRecording: true,
  touchedObject: -1,
  hip: [0.5, -0.25, 0.125],
  proxy: [0.5, -0.25, 0.25],
  force: [0, 0, 8],
  pulse: 0.5,
  pulses: 3,
  cycles: 4_000_000_000,
  lateCycles: 2,
  cycleTime: { median: 2 ** -15, p99: 2 ** -13, longest: 2 ** -12 },
  age: { tool: 2 ** -10, state: 2 ** -11, queue: 0 },
  objects: [
    {
      position: [1, 2, 3],
      quaternion: [0, 0, 0.5, 0.75],
      force: [1, 0, -1],
      phase: 'critical',
      isOutsideModel: true,
      isBlocked: false,
      isSaturated: true,
      speed: 0.0625,
    },
    {
      position: [0, 0, 0],
      quaternion: [0, 0, 0, 1],
      force: [0, 0, 0],
      phase: 'free',
      isOutsideModel: false,
      isBlocked: true,
      isSaturated: false,
      speed: 0,
    },
  ],
  arm: null,
  link: null,
};

test('a state with a link is read back as written, with and without an arm', () => {
  const tracked = {
    position: [1, 2, 3],
    quaternion: [0, 0, 0, 1],
    age: 0.5,
    isTracked: true,
  } as const;
  const robot = {
    isOnHold: true,
    isStopped: false,
    limits: 5,
    corrections: 3,
    tip: [0.5, 0.25, 0.125],
    force: [1, 2, 3],
    objects: [tracked, { ...tracked, isTracked: false }],
  };
  const stamps = {
    device: 1,
    sent: 2,
    received: 3,
    applied: 4,
    sensed: 5,
    sentBack: 6,
    receivedBack: 7,
  };
  const link = {
    isConnected: true,
    silence: 0.5,
    lead: 0.25,
    roundTrip: 0.125,
    clockStd: 2 ** -14,
    robot,
    stamps,
    picture: 70000,
    pictureAge: 0.75,
  } as unknown as LiveState['link'];
  const arm = { position: [0.5], isStopped: false, isReached: true, nearest: null };
  for (const withArm of [null, arm]) {
    const sent = { ...state, isStopped: true, link, arm: withArm };
    assert.deepEqual(readState(writeState(7, 12.5, sent)), sent);
  }
  const silent = { ...state, link: { ...link!, isConnected: false, robot: null, stamps: null } };
  assert.deepEqual(readState(writeState(7, 12.5, silent)), silent);
});

test('the stages of a delay add up to what the page sees', () => {
  const stamps = {
    device: 100, // on the page's clock, 50 s behind the server's
    sent: 150.02,
    received: 150.22,
    applied: 150.23,
    sensed: 150.24,
    sentBack: 150.25,
    receivedBack: 150.45,
  };
  const stages = linkStages(stamps, 50, 100.5)!;
  assert.equal(stages.length, stageNames.length);
  assert.ok(Math.abs(stages.reduce((a, b) => a + b) - 0.5) < 1e-9);
  assert.ok(Math.abs(stages[1] - 0.2) < 1e-9);
  assert.equal(linkStages({ ...stamps, device: NaN }, 50, 100.5), null);
});

const nearTheScan = { distance: 0.0625, link: 3, otherLink: null, object: null };

test('a state with an arm is read back as written', () => {
  for (const nearest of [
    null,
    nearTheScan,
    { ...nearTheScan, otherLink: 0 },
    { ...nearTheScan, object: 1 },
  ]) {
    const arm = { position: [0.5, -1.25], isStopped: true, isReached: false, nearest };
    assert.deepEqual(readState(writeState(7, 12.5, { ...state, arm })), { ...state, arm });
  }
});

test('a state whose arm has another length is rejected', () => {
  const arm = { position: [0.5, -1.25], isStopped: false, isReached: true, nearest: null };
  const written = new Uint8Array(writeState(7, 12.5, { ...state, arm }));
  const resized = (bytes: number) => {
    const copy = new Uint8Array(written.length + bytes);
    copy.set(written.subarray(0, copy.length));
    new DataView(copy.buffer).setUint32(12, copy.length - 24, true);
    return copy.buffer;
  };
  assert.equal(readState(resized(4)), null);
  assert.equal(readState(resized(-4)), null);
  assert.equal(readState(resized(-16)), null);
});

test('a state is read back as written', () => {
  assert.deepEqual(readState(writeState(7, 12.5, state)), state);
});

test('a state before the first tool sample has a NaN tool clock', () => {
  const read = readState(writeState(1, 0, { ...state, toolClock: NaN }));
  assert.ok(Number.isNaN(read?.toolClock));
});

test('the layout of a state matches the protocol byte for byte', () => {
  const view = new DataView(writeState(7, 12.5, state));
  assert.equal(String.fromCharCode(...new Uint8Array(view.buffer, 0, 4)), 'PCVR');
  assert.equal(view.getUint8(4), 1);
  assert.equal(view.getUint8(5), 2);
  assert.equal(view.getUint32(12, true), 104 + 2 * 48);
  assert.equal(view.getFloat64(16, true), 12.5);
  assert.equal(view.getUint32(24 + 16, true), 1 | 4 | 16 | 128 | 65536 | 262144 | (25 << 8));
  assert.equal(view.getInt32(24 + 20, true), -1);
  assert.equal(view.getFloat32(24 + 24, true), 0.5);
  assert.equal(view.getFloat32(24 + 56, true), 8);
  assert.equal(view.getUint32(24 + 68, true), 4_000_000_000);
  assert.equal(view.getUint32(24 + 100, true), 2);
  assert.equal(view.getFloat32(24 + 104 + 8, true), 3);
  assert.equal(view.getUint8(24 + 104 + 40), 2);
  assert.equal(view.getUint8(24 + 104 + 41), 5);
});

test('the layout of a tool sample matches the protocol byte for byte', () => {
  const sample = { tip: [1, 2, 3], quaternion: [0, 0, 0, 1], clutch: true, device: Device.hand };
  const view = new DataView(writeTool(9, 2.5, sample as Parameters<typeof writeTool>[2]));
  assert.equal(view.byteLength, headerBytes + 32);
  assert.equal(view.getUint8(5), 17);
  assert.equal(view.getUint32(8, true), 9);
  const floats = [0, 1, 2, 3, 4, 5, 6].map((i) => view.getFloat32(24 + 4 * i, true));
  assert.deepEqual(floats, [1, 2, 3, 0, 0, 0, 1]);
  assert.equal(view.getUint8(24 + 28), 1);
  assert.equal(view.getUint8(24 + 29), 3);
  assert.equal(view.getUint16(24 + 30, true), 0);
});

test('commands, pings and pongs have the length that the protocol specifies', () => {
  const command = new DataView(writeCommand(1, 0, Command.release));
  assert.equal(command.byteLength, headerBytes + 4);
  assert.equal(command.getUint32(24, true), 5);
  assert.equal(writePing(2, 0).byteLength, headerBytes);
  assert.equal(readPong(writePong(3, 0, 1.5)), 1.5);
  assert.equal(readPong(writePing(3, 0)), null);
});

test('JSON keeps non-ASCII characters', () => {
  const notice = { level: 'warning', text: 'Böx übér 5 µm' };
  assert.deepEqual(readJson(writeJson(MessageType.notice, 1, 0, notice)), notice);
});

test('invalid JSON is rejected', () => {
  const broken = writeJson(MessageType.notice, 1, 0, {});
  new Uint8Array(broken)[headerBytes] = 0x5b;
  assert.equal(readJson(broken), null);
});

test('a message truncated at any byte is rejected', () => {
  const whole = writeState(7, 12.5, state);
  for (let length = 0; length < whole.byteLength; ++length)
    assert.equal(readState(whole.slice(0, length)), null);
});

test('a state with a wrong number of objects is rejected', () => {
  for (const count of [0, 1, 3, 0xffffffff]) {
    const wrong = writeState(7, 12.5, state);
    new DataView(wrong).setUint32(headerBytes + 100, count, true);
    assert.equal(readState(wrong), null);
  }
});

test('a message of another version is rejected, but its version can be read', () => {
  const other = writePing(1, 0);
  new DataView(other).setUint8(4, 2);
  assert.equal(readHeader(other), null);
  assert.equal(readVersion(other), 2);
  new DataView(other).setUint8(0, 0);
  assert.equal(readVersion(other), null);
});
