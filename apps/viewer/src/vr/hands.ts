// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Quaternion, Vector3 } from 'three';

import { Press } from './press';
import type { Actuator } from './pulses';

export type Side = 'left' | 'right';

/// One hand in one frame, in the headset's space.
export interface Hand {
  side: Side;
  isHand: boolean; // tracked without a controller
  /// A controller's grip, or the midpoint of the tips of thumb and index finger.
  position: Vector3;
  rotation: Quaternion;
  rayOrigin: Vector3;
  rayDirection: Vector3; // unit
  isClutchHeld: boolean; // squeeze, trigger or pinch
  isHoldPressed: boolean; // rising edge of the lower button (A or X)
  isExtraPressed: boolean; // rising edge of the upper button (B or Y)
  stick: { x: number; y: number };
  /// Presses the panel's buttons: the index finger's tip, or the origin of a controller's ray.
  fingertip: Vector3;
  joints: Vector3[];
  actuator: Actuator | undefined;
}

// Button indices of the `xr-standard` gamepad mapping; 4 is A or X, 5 is B or Y.
const trigger = 0;
const squeeze = 1;
const lowerButton = 4;
const upperButton = 5;
// Above the value of a trigger or squeeze with a finger resting on it.
const pressThreshold = 0.5;
// Hysteresis of a pinch: distances between the tips [m].
const pinchCloseGap = 0.02;
const pinchOpenGap = 0.035;

/// One hand's buttons, kept from frame to frame.
class HandPresses {
  readonly pinch = new Press();
  readonly hold = new Press();
  readonly extra = new Press();
}

/// Reads the poses and buttons of hands and controllers, frame by frame.
export class HandReader {
  private readonly presses = { left: new HandPresses(), right: new HandPresses() };

  /// The hands tracked in this frame; an emulated position counts as not tracked.
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
    pinch.update(gap < pinchCloseGap, gap < pinchOpenGap);
    hand.isClutchHeld = pinch.isDown;
    hand.position.copy(thumb).add(index).multiplyScalar(0.5);
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
  const rayRotation = toQuaternion(aim.orientation);
  const rayOrigin = toVector(aim.position);
  return {
    side,
    isHand: false,
    position: toVector(grip.position),
    rotation: toQuaternion(grip.orientation),
    rayOrigin,
    rayDirection: new Vector3(0, 0, -1).applyQuaternion(rayRotation),
    isClutchHeld: false,
    isHoldPressed: false,
    isExtraPressed: false,
    stick: { x: 0, y: 0 },
    fingertip: rayOrigin,
    joints: [],
    actuator: undefined,
  };
}

function readButtons(gamepad: Gamepad, presses: HandPresses, hand: Hand): void {
  const valueOf = (index: number): number => gamepad.buttons[index]?.value ?? 0;
  hand.isClutchHeld = valueOf(trigger) > pressThreshold || valueOf(squeeze) > pressThreshold;
  hand.isHoldPressed = presses.hold.update(valueOf(lowerButton) > pressThreshold);
  hand.isExtraPressed = presses.extra.update(valueOf(upperButton) > pressThreshold);
  // Axes 2 and 3 are the thumbstick's, 0 and 1 the touchpad's.
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
