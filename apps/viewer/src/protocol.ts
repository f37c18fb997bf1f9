// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The messages of docs/live-protocol.md, both ways. Little-endian; metres, newtons, seconds, base
// frame (z up), quaternions x y z w. What is malformed gives null, never an exception.

export const protocolVersion = 1;
export const headBytes = 24;
const magic = 0x52564350; // "PCVR"
const stateBytes = 104;
const objectBytes = 48;

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

export const Command = { hold: 1, goOn: 2, reset: 3, take: 4, giveBack: 5 } as const;
export type Command = (typeof Command)[keyof typeof Command];

export const Device = { mouse: 0, keyboard: 1, controller: 2, hand: 3 } as const;
export type Device = (typeof Device)[keyof typeof Device];

export const phaseNames = ['free', 'static', 'critical', 'sliding'] as const;
export type Phase = (typeof phaseNames)[number];

export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number];

export interface Head {
  type: number;
  sequence: number;
  length: number; // [bytes] of what follows the head
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
}

export interface Notice {
  level: 'info' | 'warning' | 'error';
  text: string;
}

export interface ObjectState {
  position: Vector;
  quaternion: Quaternion;
  force: Vector; // [N] of the tool on it
  phase: Phase;
  isOutsideModel: boolean;
  speed: number; // [m/s]
}

export interface LiveState {
  clock: number; // [s] the server's, when it was sent
  sequence: number;
  worldTime: number; // [s]
  toolClock: number; // [s] this page's clock at the newest sample used; NaN before the first
  isEngaged: boolean;
  isOnHold: boolean;
  touchesScan: boolean;
  hasTool: boolean; // this page
  isToolTaken: boolean; // by anybody
  touchedObject: number; // -1: none
  hip: Vector;
  proxy: Vector;
  force: Vector; // [N] on the hand
  pulse: number; // 0 to 1
  pulses: number;
  cycles: number;
  lateCycles: number;
  cycleTime: { median: number; p99: number; longest: number }; // [s]
  age: { tool: number; state: number; queue: number }; // [s]
  objects: ObjectState[];
}

export interface ToolSample {
  tip: Vector;
  quaternion: Quaternion;
  clutch: boolean;
  device: Device;
}

/// Checks the head; null where this isn't one whole message of this version.
export function readHead(buffer: ArrayBuffer): Head | null {
  if (buffer.byteLength < headBytes) return null;
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== magic) return null;
  if (view.getUint8(4) !== protocolVersion || view.getUint16(6, true) !== 0) return null;
  const length = view.getUint32(12, true);
  if (length !== buffer.byteLength - headBytes) return null;
  return {
    type: view.getUint8(5),
    sequence: view.getUint32(8, true),
    length,
    clock: view.getFloat64(16, true),
  };
}

/// The version in a message's head, also of one that `readHead` refuses; null where it is none.
export function readVersion(buffer: ArrayBuffer): number | null {
  if (buffer.byteLength < headBytes) return null;
  const view = new DataView(buffer);
  return view.getUint32(0, true) === magic ? view.getUint8(4) : null;
}

/// The JSON of a welcome or a notice.
export function readJson<T>(buffer: ArrayBuffer): T | null {
  try {
    const value: unknown = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, headBytes)));
    return typeof value === 'object' && value !== null ? (value as T) : null;
  } catch {
    return null;
  }
}

/// The ping's own clock [s], out of a pong.
export function readPong(buffer: ArrayBuffer): number | null {
  return buffer.byteLength === headBytes + 8
    ? new DataView(buffer).getFloat64(headBytes, true)
    : null;
}

export function readState(buffer: ArrayBuffer): LiveState | null {
  const head = readHead(buffer);
  if (head === null || head.type !== MessageType.state || head.length < stateBytes) return null;
  const view = new DataView(buffer, headBytes);
  const count = view.getUint32(100, true);
  if (head.length !== stateBytes + count * objectBytes) return null;
  const f32 = (at: number) => view.getFloat32(at, true);
  const flags = view.getUint32(16, true);
  const objects: ObjectState[] = [];
  for (let i = 0; i < count; ++i) objects.push(readObject(view, stateBytes + i * objectBytes));
  return {
    clock: head.clock,
    sequence: head.sequence,
    worldTime: view.getFloat64(0, true),
    toolClock: view.getFloat64(8, true),
    isEngaged: (flags & 1) !== 0,
    isOnHold: (flags & 2) !== 0,
    touchesScan: (flags & 4) !== 0,
    hasTool: (flags & 8) !== 0,
    isToolTaken: (flags & 16) !== 0,
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
    speed: view.getFloat32(at + 44, true),
  };
}

/// A message with its head, and room for `length` bytes after its head.
export function message(type: number, sequence: number, clock: number, length: number): DataView {
  const view = new DataView(new ArrayBuffer(headBytes + length));
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
  const view = message(type, sequence, clock, bytes.length);
  new Uint8Array(view.buffer, headBytes).set(bytes);
  return view.buffer as ArrayBuffer;
}

export function writeTool(sequence: number, clock: number, sample: ToolSample): ArrayBuffer {
  const view = message(MessageType.tool, sequence, clock, 32);
  [...sample.tip, ...sample.quaternion].forEach((value, i) =>
    view.setFloat32(headBytes + 4 * i, value, true),
  );
  view.setUint8(headBytes + 28, sample.clutch ? 1 : 0);
  view.setUint8(headBytes + 29, sample.device);
  return view.buffer as ArrayBuffer;
}

export function writeCommand(sequence: number, clock: number, command: Command): ArrayBuffer {
  const view = message(MessageType.command, sequence, clock, 4);
  view.setUint32(headBytes, command, true);
  return view.buffer as ArrayBuffer;
}

export function writePing(sequence: number, clock: number): ArrayBuffer {
  return message(MessageType.ping, sequence, clock, 0).buffer as ArrayBuffer;
}
