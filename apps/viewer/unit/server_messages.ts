// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The server's messages, as specified in docs/live-protocol.md.
import { linkBytes, linkObjectBytes, type LinkInfo } from '../src/link_protocol';
import { headerBytes, makeMessage, MessageType, phaseNames, type LiveState } from '../src/protocol';

const stateBytes = 104;
const objectBytes = 48;
const armBytes = 20;

/// The server's answer to a ping.
export function writePong(sequence: number, clock: number, pingClock: number): ArrayBuffer {
  const view = makeMessage(MessageType.pong, sequence, clock, 8);
  view.setFloat64(headerBytes, pingClock, true);
  return view.buffer as ArrayBuffer;
}

/// The server's state message.
export function writeState(sequence: number, clock: number, state: LiveState): ArrayBuffer {
  const armAt = stateBytes + objectBytes * state.objects.length;
  const linkAt = armAt + (state.arm ? armBytes + 4 * state.arm.position.length : 0);
  const linkLength = state.link ? linkBytes + linkObjectBytes * state.objects.length : 0;
  const view = makeMessage(MessageType.state, sequence, clock, linkAt + linkLength);
  const f32 = (at: number, values: readonly number[]) =>
    values.forEach((value, i) => view.setFloat32(headerBytes + at + 4 * i, value, true));
  const u32 = (at: number, value: number) => view.setUint32(headerBytes + at, value, true);
  view.setFloat64(headerBytes, state.worldTime, true);
  view.setFloat64(headerBytes + 8, state.toolClock, true);
  const flags = [
    state.isEngaged,
    state.isOnHold,
    state.touchesScan,
    state.hasTool,
    state.isToolTaken,
    state.isStopped,
    state.link !== null,
  ];
  u32(
    16,
    flags.reduce(
      (bits, flag, i) => bits | (flag ? 1 << i : 0),
      (Math.round(100 * state.timeScale) << 8) |
        (state.canUndoReset ? 128 : 0) |
        (state.isToolWanted ? 0x10000 : 0) |
        (state.hasAsked ? 0x20000 : 0) |
        (state.isRecording ? 0x40000 : 0),
    ),
  );
  view.setInt32(headerBytes + 20, state.touchedObject, true);
  f32(24, [...state.hip, ...state.proxy, ...state.force, state.pulse]);
  u32(64, state.pulses);
  u32(68, state.cycles);
  u32(72, state.lateCycles);
  f32(76, [state.cycleTime.median, state.cycleTime.p99, state.cycleTime.longest]);
  f32(88, [state.age.tool, state.age.state, state.age.queue]);
  u32(100, state.objects.length);
  state.objects.forEach((object, i) => {
    const at = stateBytes + i * objectBytes;
    f32(at, [...object.position, ...object.quaternion, ...object.force]);
    view.setUint8(headerBytes + at + 40, phaseNames.indexOf(object.phase));
    view.setUint8(
      headerBytes + at + 41,
      (object.isOutsideModel ? 1 : 0) + (object.isBlocked ? 2 : 0) + (object.isSaturated ? 4 : 0),
    );
    f32(at + 44, [object.speed]);
  });
  if (state.arm) {
    const { position, isStopped, isReached, nearest } = state.arm;
    const isItself = nearest !== null && nearest.otherLink !== null;
    u32(armAt, position.length);
    u32(
      armAt + 4,
      (isStopped ? 1 : 0) | (isReached ? 2 : 0) | (nearest ? 4 : 0) | (isItself ? 8 : 0),
    );
    f32(armAt + 8, [nearest?.distance ?? 0]);
    u32(armAt + 12, nearest?.link ?? 0);
    u32(armAt + 16, nearest?.otherLink ?? nearest?.object ?? 0xffffffff);
    f32(armAt + armBytes, position);
  }
  if (state.link) writeLink(new DataView(view.buffer, headerBytes + linkAt), state.link);
  return view.buffer as ArrayBuffer;
}

function writeLink(view: DataView, link: LinkInfo): void {
  const { robot, stamps } = link;
  const f32 = (at: number, values: readonly number[]) =>
    values.forEach((value, i) => view.setFloat32(at + 4 * i, value, true));
  const flags = [link.isConnected, robot, robot?.isOnHold, robot?.isStopped, stamps];
  view.setUint32(
    0,
    flags.reduce<number>((bits, flag, i) => bits | (flag ? 1 << i : 0), 0),
    true,
  );
  view.setUint32(4, robot?.limits ?? 0, true);
  view.setUint32(8, robot?.corrections ?? 0, true);
  f32(12, [link.silence, link.lead, link.roundTrip, link.clockStd]);
  f32(28, [...(robot?.tip ?? []), ...(robot?.force ?? [])]);
  const { device, sent, received, applied, sensed, sentBack, receivedBack } = stamps ?? {};
  [device, sent, received, applied, sensed, sentBack, receivedBack].forEach((stamp, i) =>
    view.setFloat64(52 + 8 * i, stamp ?? NaN, true),
  );
  view.setUint32(108, link.picture, true);
  f32(112, [link.pictureAge]);
  robot?.objects.forEach(({ position, quaternion, age, isTracked }, i) => {
    const at = linkBytes + i * linkObjectBytes;
    f32(at, [...position, ...quaternion, age]);
    view.setUint32(at + 32, isTracked ? 1 : 0, true);
  });
}
