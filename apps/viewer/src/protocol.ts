// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The messages of docs/live-protocol.md, both ways. Little-endian; metres, newtons, seconds, base
// frame (z up), quaternions x y z w. A malformed message gives null, never an exception.

import type { Quaternion, Vector } from './coordinates';
import { linkBytes, linkObjectBytes, readLink, type LinkInfo } from './link_protocol';

export type { Quaternion, Vector } from './coordinates';

export const protocolVersion = 1;
export const headerBytes = 24;
const magic = 0x52564350; // "PCVR"
const stateBytes = 104;
const objectBytes = 48;
const armBytes = 20; // of a state's arm, before its joints' positions
const noObject = 0xffffffff;

export const MessageType = {
  welcome: 1,
  state: 2,
  notice: 3,
  pong: 4,
  hello: 16,
  tool: 17,
  command: 18,
  ping: 19,
} as const;

export const Command = {
  hold: 1,
  resume: 2,
  reset: 3,
  take: 4,
  release: 5,
  slower: 6,
  faster: 7,
  emergencyStop: 8,
  releaseStop: 9,
  undoReset: 10,
  handOver: 11,
  keep: 12,
  startRecording: 13,
  stopRecording: 14,
} as const;
export type Command = (typeof Command)[keyof typeof Command];

export const Device = { mouse: 0, keyboard: 1, controller: 2, hand: 3 } as const;
export type Device = (typeof Device)[keyof typeof Device];

export const phaseNames = ['free', 'static', 'critical', 'sliding'] as const;
export type Phase = (typeof phaseNames)[number];

export interface Header {
  type: number;
  sequence: number;
  length: number; // [bytes] after the header
  clock: number; // [s] the sender's
}

export interface Welcome {
  protocol: number;
  version: string;
  mode: 'live' | 'replay';
  scene: string;
  objects: string[];
  tool_radius: number; // [m]
  rate: number; // [Hz] of the world
  device: string;
  can_record?: boolean; // sessions, at a page's request
}

export interface Notice {
  level: 'info' | 'warning' | 'error';
  text: string;
  about?: 'recording';
}

export interface ObjectState {
  position: Vector;
  quaternion: Quaternion;
  force: Vector; // [N] of the tool on the object
  phase: Phase;
  isOutsideModel: boolean;
  isBlocked: boolean; // pressed against the scan, which holds it
  isSaturated: boolean; // the force on it is at its maximum
  speed: number; // [m/s]
}

/// The nearest two things of the arm's surroundings; without link and object: the scan.
export interface NearestState {
  distance: number; // [m]
  link: number;
  otherLink: number | null;
  object: number | null;
}

export interface ArmState {
  position: number[]; // of the joints [rad or m]
  isStopped: boolean; // before a collision
  isReached: boolean; // the tip is at the tool
  nearest: NearestState | null; // null: nothing is near
}

export interface LiveState {
  clock: number; // [s] the server's, when it was sent
  sequence: number;
  worldTime: number; // [s]
  toolClock: number; // [s] this page's clock at the newest sample used; NaN before the first
  isEngaged: boolean;
  isOnHold: boolean;
  isStopped: boolean; // emergency stop
  timeScale: number; // simulated over real time
  touchesScan: boolean;
  hasTool: boolean; // this page
  isToolTaken: boolean; // by any page
  canUndoReset: boolean; // since the last reset no body was touched
  isToolWanted: boolean; // this page has the tool, and another one asks for it
  hasAsked: boolean; // this page has asked for the tool
  isRecording: boolean; // the server writes the session to a folder
  touchedObject: number; // -1: none
  hip: Vector; // haptic interface point: where the hand is
  proxy: Vector; // god-object: the tool's sphere, kept outside of all surfaces
  force: Vector; // [N] on the hand
  pulse: number; // 0 to 1: intensity for a controller's motor
  pulses: number; // events so far: breakaways and first contacts
  cycles: number;
  lateCycles: number;
  cycleTime: { median: number; p99: number; longest: number }; // [s]
  age: { tool: number; state: number; queue: number }; // [s]
  objects: ObjectState[];
  arm: ArmState | null;
  link: LinkInfo | null; // at an operator's site
}

export interface ToolSample {
  tip: Vector;
  quaternion: Quaternion;
  clutch: boolean;
  device: Device;
}

/// Reads the header; null unless this is one complete message of this version.
export function readHeader(buffer: ArrayBuffer): Header | null {
  if (buffer.byteLength < headerBytes) return null;
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== magic) return null;
  if (view.getUint8(4) !== protocolVersion || view.getUint16(6, true) !== 0) return null;
  const length = view.getUint32(12, true);
  if (length !== buffer.byteLength - headerBytes) return null;
  return {
    type: view.getUint8(5),
    sequence: view.getUint32(8, true),
    length,
    clock: view.getFloat64(16, true),
  };
}

/// The version in a message's header, also of one that `readHeader` rejects; null if it has none.
export function readVersion(buffer: ArrayBuffer): number | null {
  if (buffer.byteLength < headerBytes) return null;
  const view = new DataView(buffer);
  return view.getUint32(0, true) === magic ? view.getUint8(4) : null;
}

/// The JSON of a welcome or a notice.
export function readJson<T>(buffer: ArrayBuffer): T | null {
  try {
    const text = new TextDecoder().decode(new Uint8Array(buffer, headerBytes));
    const value: unknown = JSON.parse(text);
    return typeof value === 'object' && value !== null ? (value as T) : null;
  } catch {
    return null;
  }
}

/// The clock that the ping was sent at [s], echoed by a pong.
export function readPong(buffer: ArrayBuffer): number | null {
  return buffer.byteLength === headerBytes + 8
    ? new DataView(buffer).getFloat64(headerBytes, true)
    : null;
}

export function readState(buffer: ArrayBuffer): LiveState | null {
  const header = readHeader(buffer);
  if (header === null || header.type !== MessageType.state || header.length < stateBytes)
    return null;
  const view = new DataView(buffer, headerBytes);
  const count = view.getUint32(100, true);
  const armAt = stateBytes + count * objectBytes;
  const flags = view.getUint32(16, true);
  const linkLength = (flags & 64) !== 0 ? linkBytes + count * linkObjectBytes : 0;
  const hasArm = header.length - linkLength >= armAt + armBytes;
  const armLength = hasArm ? armBytes + 4 * view.getUint32(armAt, true) : 0;
  if (header.length !== armAt + armLength + linkLength) return null;
  const f32 = (at: number) => view.getFloat32(at, true);
  const objects: ObjectState[] = [];
  for (let i = 0; i < count; ++i) objects.push(readObject(view, stateBytes + i * objectBytes));
  return {
    clock: header.clock,
    sequence: header.sequence,
    worldTime: view.getFloat64(0, true),
    toolClock: view.getFloat64(8, true),
    isEngaged: (flags & 1) !== 0,
    isOnHold: (flags & 2) !== 0,
    isStopped: (flags & 32) !== 0,
    timeScale: ((flags >>> 8) & 0xff) / 100,
    touchesScan: (flags & 4) !== 0,
    hasTool: (flags & 8) !== 0,
    isToolTaken: (flags & 16) !== 0,
    canUndoReset: (flags & 128) !== 0,
    isToolWanted: (flags & 0x10000) !== 0,
    hasAsked: (flags & 0x20000) !== 0,
    isRecording: (flags & 0x40000) !== 0,
    touchedObject: view.getInt32(20, true),
    hip: readVector(view, 24),
    proxy: readVector(view, 36),
    force: readVector(view, 48),
    pulse: f32(60),
    pulses: view.getUint32(64, true),
    cycles: view.getUint32(68, true),
    lateCycles: view.getUint32(72, true),
    cycleTime: { median: f32(76), p99: f32(80), longest: f32(84) },
    age: { tool: f32(88), state: f32(92), queue: f32(96) },
    objects,
    arm: hasArm ? readArm(view, armAt) : null,
    link: linkLength > 0 ? readLink(view, armAt + armLength, count) : null,
  };
}

function readArm(view: DataView, at: number): ArmState {
  const flags = view.getUint32(at + 4, true);
  const other = view.getUint32(at + 16, true);
  const isItself = (flags & 8) !== 0;
  return {
    position: Array.from({ length: view.getUint32(at, true) }, (_, i) =>
      view.getFloat32(at + armBytes + 4 * i, true),
    ),
    isStopped: (flags & 1) !== 0,
    isReached: (flags & 2) !== 0,
    nearest:
      (flags & 4) === 0
        ? null
        : {
            distance: view.getFloat32(at + 8, true),
            link: view.getUint32(at + 12, true),
            otherLink: isItself ? other : null,
            object: isItself || other === noObject ? null : other,
          },
  };
}

function readVector(view: DataView, at: number): Vector {
  return [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
}

function readObject(view: DataView, at: number): ObjectState {
  const [x, y, z] = readVector(view, at + 12);
  return {
    position: readVector(view, at),
    quaternion: [x, y, z, view.getFloat32(at + 24, true)],
    force: readVector(view, at + 28),
    phase: phaseNames[Math.min(view.getUint8(at + 40), phaseNames.length - 1)],
    isOutsideModel: (view.getUint8(at + 41) & 1) !== 0,
    isBlocked: (view.getUint8(at + 41) & 2) !== 0,
    isSaturated: (view.getUint8(at + 41) & 4) !== 0,
    speed: view.getFloat32(at + 44, true),
  };
}

/// A message with its header, and `length` zero bytes after it.
export function makeMessage(
  type: number,
  sequence: number,
  clock: number,
  length: number,
): DataView {
  const view = new DataView(new ArrayBuffer(headerBytes + length));
  view.setUint32(0, magic, true);
  view.setUint8(4, protocolVersion);
  view.setUint8(5, type);
  view.setUint32(8, sequence, true);
  view.setUint32(12, length, true);
  view.setFloat64(16, clock, true);
  return view;
}

/// A hello, a welcome or a notice.
export function writeJson(type: number, sequence: number, clock: number, value: object) {
  const bytes = new TextEncoder().encode(JSON.stringify(value));
  const view = makeMessage(type, sequence, clock, bytes.length);
  new Uint8Array(view.buffer, headerBytes).set(bytes);
  return view.buffer as ArrayBuffer;
}

export function writeTool(sequence: number, clock: number, sample: ToolSample): ArrayBuffer {
  const view = makeMessage(MessageType.tool, sequence, clock, 32);
  [...sample.tip, ...sample.quaternion].forEach((value, i) =>
    view.setFloat32(headerBytes + 4 * i, value, true),
  );
  view.setUint8(headerBytes + 28, sample.clutch ? 1 : 0);
  view.setUint8(headerBytes + 29, sample.device);
  return view.buffer as ArrayBuffer;
}

export function writeCommand(sequence: number, clock: number, command: Command): ArrayBuffer {
  const view = makeMessage(MessageType.command, sequence, clock, 4);
  view.setUint32(headerBytes, command, true);
  return view.buffer as ArrayBuffer;
}

export function writePing(sequence: number, clock: number): ArrayBuffer {
  return makeMessage(MessageType.ping, sequence, clock, 0).buffer as ArrayBuffer;
}
