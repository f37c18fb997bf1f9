// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector3 } from 'three';

import type { Hand } from './hands';
import { worldScales, type Person } from './person';
import { Press } from './press';
import { landing, type Level, TeleportView, throwPath } from './teleport';

const snapAngle = Math.PI / 6;
// A stick counts when pushed this far, and is ready again when it came back this far.
const pushedAt = 0.7;
const backAt = 0.3;

/// Moves the person by the free hand: teleport, snap turn, scale. Never the tool.
export class Moving {
  readonly view = new TeleportView();
  private readonly turned = new Press();
  /// Where a teleport would go [m], in base, while one is aimed.
  target: Vector3 | undefined;

  constructor(
    private readonly person: Person,
    private readonly levels: () => Level[],
  ) {}

  /// Once a frame, with the hand that does not hold the tool; `pivot` is where a scale keeps still.
  update(hand: Hand | undefined, head: Vector3, pivot: Vector3): void {
    if (hand === undefined) {
      this.stop();
      return;
    }
    this.turn(hand, head);
    if (hand.beginsExtra) this.person.scaleTo(nextScale(this.person.scale), pivot);
    this.teleport(hand, head);
  }

  /// Gives up what was begun; nobody is moved.
  stop(): void {
    this.target = undefined;
    this.view.hide();
  }

  private turn(hand: Hand, head: Vector3): void {
    const aside = Math.abs(hand.stick.x);
    if (this.turned.update(aside >= pushedAt, aside >= backAt))
      this.person.turnBy(hand.stick.x > 0 ? -snapAngle : snapAngle, head);
  }

  private teleport(hand: Hand, head: Vector3): void {
    const wants = hand.isHand ? hand.isClutchHeld : hand.stick.y < -pushedAt;
    const goes = hand.isHand ? !hand.isClutchHeld : hand.stick.y > -backAt;
    if (wants) {
      this.aim(hand);
    } else if (goes && this.target !== undefined) {
      this.person.goTo(this.target, head);
      this.stop();
    } else if (goes) {
      this.stop();
    }
  }

  private aim(hand: Hand): void {
    const from = this.person.toBase(hand.aimFrom);
    const along = hand.aimAlong.clone().applyQuaternion(this.person.rig.quaternion);
    const path = throwPath(from, along, this.person.scale);
    const landed = landing(path, this.levels());
    this.target = landed?.place;
    if (landed === undefined) {
      this.view.hide();
    } else {
      this.view.show(landed.path, landed.place, this.person.scale);
    }
  }
}

/// The next larger scale; after the largest the smallest.
export function nextScale(scale: number): number {
  return worldScales.find((s) => s > scale) ?? worldScales[0];
}
