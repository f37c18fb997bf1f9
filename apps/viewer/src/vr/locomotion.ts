// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector3 } from 'three';

import type { Hand } from './hands';
import { worldScales, type Person } from './person';
import { Press } from './press';
import { ballisticPath, findLanding, type Level, TeleportView } from './teleport';

export const snapAngle = Math.PI / 6;
// Hysteresis of a thumbstick's deflection.
const stickOn = 0.7;
const stickOff = 0.3;

/// Locomotion by the free hand: teleport, snap turn, world scale. Never moves the tool.
export class Locomotion {
  readonly view = new TeleportView();
  private readonly snapTurn = new Press();
  /// The target of the teleport that is being aimed [m], in base.
  target: Vector3 | undefined;

  constructor(
    private readonly person: Person,
    private readonly levels: () => Level[],
  ) {}

  /// Once a frame, with the hand that does not have the tool; `pivot`: fixed point of a scaling.
  update(hand: Hand | undefined, head: Vector3, pivot: Vector3): void {
    if (hand === undefined) {
      this.stop();
      return;
    }
    this.turn(hand, head);
    if (hand.isExtraPressed) this.person.scaleTo(nextScale(this.person.scale), pivot);
    this.teleport(hand, head);
  }

  /// Cancels a teleport that is being aimed.
  stop(): void {
    this.target = undefined;
    this.view.hide();
  }

  private turn(hand: Hand, head: Vector3): void {
    const deflection = Math.abs(hand.stick.x);
    if (this.snapTurn.update(deflection >= stickOn, deflection >= stickOff))
      this.person.turnBy(hand.stick.x > 0 ? -snapAngle : snapAngle, head);
  }

  private teleport(hand: Hand, head: Vector3): void {
    const isAiming = hand.isHand ? hand.isClutchHeld : hand.stick.y < -stickOn;
    const isReleased = hand.isHand ? !hand.isClutchHeld : hand.stick.y > -stickOff;
    if (isAiming) {
      this.aim(hand);
    } else if (isReleased && this.target !== undefined) {
      this.person.goTo(this.target, head);
      this.stop();
    } else if (isReleased) {
      this.stop();
    }
  }

  private aim(hand: Hand): void {
    const from = this.person.toBase(hand.rayOrigin);
    const direction = hand.rayDirection.clone().applyQuaternion(this.person.rig.quaternion);
    const path = ballisticPath(from, direction, this.person.scale);
    const landing = findLanding(path, this.levels());
    this.target = landing?.point;
    if (landing === undefined) {
      this.view.hide();
    } else {
      this.view.show(landing.path, landing.point, this.person.scale);
    }
  }
}

/// The next larger scale; wraps around to the smallest.
export function nextScale(scale: number): number {
  return worldScales.find((s) => s > scale) ?? worldScales[0];
}
