// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Quaternion, Vector3 } from 'three';

import { Press } from './press';
import type { Actuator } from './pulses';

export type Side = 'left' | 'right';

/// One hand in one frame, in the headset's space.
export interface Hand {
  side: Side;
  isHand: boolean; // bare, without a controller
  /// Where it is: a controller's grip, or between the tips of thumb and index finger.
  place: Vector3;
  rotation: Quaternion;
  aimFrom: Vector3;
  aimAlong: Vector3; // unit
  isClutchHeld: boolean; // squeeze, trigger or pinch
  beginsHold: boolean; // the lower button, in the frame in which it is pressed
  beginsExtra: boolean; // the upper one
  stick: { x: number; y: number };
  /// What presses buttons: the index finger's tip, or a controller's.
  fingertip: Vector3;
  joints: Vector3[];
  actuator: Actuator | undefined;
}

// The places of gamepad buttons in the `xr-standard` mapping; from 4 on, A or X, and B or Y.
const trigger = 0;
const squeeze = 1;
const lowerButton = 4;
const upperButton = 5;
// How far a trigger or squeeze is drawn to count: a finger at rest on it does not.
const drawnEnough = 0.5;
// Tips this near to each other pinch, and must part further to let go [m].
const pinchClosesAt = 0.02;
const pinchOpensAt = 0.035;

/// What one hand holds down from frame to frame.
class HandPresses {
  readonly pinch = new Press();
  readonly hold = new Press();
  readonly extra = new Press();
}

/// Reads hands and controllers, frame by frame.
export class HandReader {
  private readonly presses = { left: new HandPresses(), right: new HandPresses() };

  /// Those that are tracked in this frame; a guessed place is not tracked.
  read(frame: XRFrame, space: XRReferenceSpace): Hand[] {
    const hands: Hand[] = [];
    for (const source of frame.session.inputSources) {
      const hand = this.readOne(frame, space, source);
      if (hand !== undefined) hands.push(hand);
    }
    return hands;
  }

  private readOne(
    frame: XRFrame,
    space: XRReferenceSpace,
    source: XRInputSource,
  ): Hand | undefined {
    if (source.handedness === 'none' || source.gripSpace === undefined) return undefined;
    const grip = frame.getPose(source.gripSpace, space);
    const aim = frame.getPose(source.targetRaySpace, space);
    if (!grip || !aim || grip.emulatedPosition) return undefined;
    const hand = fromPoses(source.handedness, grip.transform, aim.transform);
    if (source.hand) {
      hand.isHand = true;
      if (!this.readFingers(frame, space, source.hand, hand)) return undefined;
    } else if (source.gamepad) {
      readButtons(source.gamepad, this.presses[hand.side], hand);
    }
    return hand;
  }

  private readFingers(
    frame: XRFrame,
    space: XRReferenceSpace,
    fingers: XRHand,
    hand: Hand,
  ): boolean {
    for (const joint of fingers.values()) {
      const pose = frame.getJointPose?.(joint, space);
      if (pose) hand.joints.push(toVector(pose.transform.position));
    }
    const thumb = jointAt(frame, space, fingers, 'thumb-tip');
    const index = jointAt(frame, space, fingers, 'index-finger-tip');
    if (thumb === undefined || index === undefined) return false;
    const gap = thumb.distanceTo(index);
    const { pinch } = this.presses[hand.side];
    pinch.update(gap < pinchClosesAt, gap < pinchOpensAt);
    hand.isClutchHeld = pinch.isDown;
    hand.place.copy(thumb).add(index).multiplyScalar(0.5);
    hand.fingertip = index;
    return true;
  }
}

function jointAt(
  frame: XRFrame,
  space: XRReferenceSpace,
  fingers: XRHand,
  name: XRHandJoint,
): Vector3 | undefined {
  const joint = fingers.get(name);
  const pose = joint && frame.getJointPose?.(joint, space);
  return pose ? toVector(pose.transform.position) : undefined;
}

function fromPoses(side: Side, grip: XRRigidTransform, aim: XRRigidTransform): Hand {
  const turn = toQuaternion(aim.orientation);
  const aimFrom = toVector(aim.position);
  return {
    side,
    isHand: false,
    place: toVector(grip.position),
    rotation: toQuaternion(grip.orientation),
    aimFrom,
    aimAlong: new Vector3(0, 0, -1).applyQuaternion(turn),
    isClutchHeld: false,
    beginsHold: false,
    beginsExtra: false,
    stick: { x: 0, y: 0 },
    fingertip: aimFrom,
    joints: [],
    actuator: undefined,
  };
}

function readButtons(gamepad: Gamepad, presses: HandPresses, hand: Hand): void {
  const drawn = (at: number): number => gamepad.buttons[at]?.value ?? 0;
  hand.isClutchHeld = drawn(trigger) > drawnEnough || drawn(squeeze) > drawnEnough;
  hand.beginsHold = presses.hold.update(drawn(lowerButton) > drawnEnough);
  hand.beginsExtra = presses.extra.update(drawn(upperButton) > drawnEnough);
  // 2 and 3 are a thumbstick's; 0 and 1 a touchpad's.
  const hasStick = gamepad.axes.length >= 4;
  hand.stick.x = gamepad.axes[hasStick ? 2 : 0] ?? 0;
  hand.stick.y = gamepad.axes[hasStick ? 3 : 1] ?? 0;
  hand.actuator = (gamepad as unknown as { hapticActuators?: Actuator[] }).hapticActuators?.[0];
}

export function toVector(p: DOMPointReadOnly): Vector3 {
  return new Vector3(p.x, p.y, p.z);
}

export function toQuaternion(q: DOMPointReadOnly): Quaternion {
  return new Quaternion(q.x, q.y, q.z, q.w);
}
