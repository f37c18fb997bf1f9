// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { type Quaternion, Vector3 } from 'three';
import type { Hand } from './hands';
import type { Person } from './person';

/// The direction in which a hand points, about the vertical [rad].
function headingOf(rotation: Quaternion): number {
  const forward = new Vector3(0, 0, -1).applyQuaternion(rotation);
  return Math.atan2(-forward.x, -forward.z);
}

/// Places the scene in the real room: while a hand grips it, the scene follows the hand's position
/// and its turns about the vertical. Gravity keeps the scene upright.
export class Placing {
  isActive = false;
  private grip: { side: string; point: Vector3; heading: number } | null = null;

  constructor(private readonly person: Person) {}

  toggle(): void {
    this.isActive = !this.isActive;
    this.grip = null;
  }

  /// Once a frame.
  update(hands: readonly Hand[]): void {
    if (!this.isActive) return;
    const held = hands.filter((hand) => hand.isClutchHeld);
    const hand = held.find(({ side }) => side === this.grip?.side) ?? held[0];
    if (!hand) {
      this.grip = null;
      return;
    }
    const heading = headingOf(hand.rotation);
    if (this.grip?.side !== hand.side) {
      this.grip = { side: hand.side, point: this.person.toBase(hand.position), heading };
      return;
    }
    // To the shorter side of the full turn.
    const turn = heading - this.grip.heading;
    this.person.turnBy(-Math.atan2(Math.sin(turn), Math.cos(turn)), hand.position);
    this.grip.heading = heading;
    this.person.bring(this.grip.point, hand.position);
  }
}
