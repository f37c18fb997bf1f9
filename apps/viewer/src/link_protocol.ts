// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The part of a state about the link to a robot's site: docs/live-protocol.md.
import type { Quaternion, Vector } from './coordinates';

export const linkBytes = 116; // before the objects
export const linkObjectBytes = 36;

/// One command's way, on the server's clock [s]; `device` on this page's, NaN if another page's.
export interface LinkStamps {
  device: number;
  sent: number;
  received: number;
  applied: number;
  sensed: number;
  sentBack: number;
  receivedBack: number;
}

export interface TrackedObject {
  position: Vector;
  quaternion: Quaternion;
  age: number; // [s] of the frame
  isTracked: boolean;
}

export interface RobotState {
  isOnHold: boolean;
  isStopped: boolean; // emergency stop
  limits: number; // bits
  corrections: number;
  tip: Vector; // measured
  force: Vector; // [N] that its tool exerts
  objects: TrackedObject[];
}

export interface LinkInfo {
  isConnected: boolean;
  silence: number; // [s] since a message from the robot's site
  lead: number; // [s] of the shown world before the robot's
  roundTrip: number; // [s]
  clockStd: number; // [s]
  robot: RobotState | null;
  stamps: LinkStamps | null;
  picture: number; // of the robot's camera, the newest; 0: none
  pictureAge: number; // [s]
}

export function readLink(view: DataView, at: number, count: number): LinkInfo {
  const flags = view.getUint32(at, true);
  const f32 = (offset: number) => view.getFloat32(at + offset, true);
  const f64 = (offset: number) => view.getFloat64(at + offset, true);
  const vector = (offset: number): Vector => [f32(offset), f32(offset + 4), f32(offset + 8)];
  const objects = Array.from({ length: count }, (_, i): TrackedObject => {
    const start = linkBytes + i * linkObjectBytes;
    return {
      position: vector(start),
      quaternion: [...vector(start + 12), f32(start + 24)] as Quaternion,
      age: f32(start + 28),
      isTracked: view.getUint32(at + start + 32, true) !== 0,
    };
  });
  return {
    isConnected: (flags & 1) !== 0,
    silence: f32(12),
    lead: f32(16),
    roundTrip: f32(20),
    clockStd: f32(24),
    robot:
      (flags & 2) === 0
        ? null
        : {
            isOnHold: (flags & 4) !== 0,
            isStopped: (flags & 8) !== 0,
            limits: view.getUint32(at + 4, true),
            corrections: view.getUint32(at + 8, true),
            tip: vector(28),
            force: vector(40),
            objects,
          },
    stamps:
      (flags & 16) === 0
        ? null
        : {
            device: f64(52),
            sent: f64(60),
            received: f64(68),
            applied: f64(76),
            sensed: f64(84),
            sentBack: f64(92),
            receivedBack: f64(100),
          },
    picture: view.getUint32(at + 108, true),
    pictureAge: f32(112),
  };
}
