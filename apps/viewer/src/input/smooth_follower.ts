// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';

/// [s] of each of two stages. A pointer moves by whole pixels, some 1 mm: against a body of 15 N/mm
/// each would be a blow of 15 N, at up to 60 a second. Two stages leave a fortieth of that at 40 Hz.
const timeConstant = 0.03;

/// Follows a pointer's target without its steps: two low-pass filters of first order, 60 ms late.
export class SmoothFollower {
  private stage: Vector3 | null = null;

  /// The next move begins at rest.
  reset(): void {
    this.stage = null;
  }

  /// Moves `tip` towards `target` for `seconds`, at `maxSpeed` [m/s] at most.
  follow(seconds: number, tip: Vector3, target: Vector3, maxSpeed: number): void {
    const share = 1 - Math.exp(-seconds / timeConstant);
    this.stage ??= tip.clone();
    this.stage.lerp(target, share);
    const step = this.stage.clone().sub(tip).multiplyScalar(share);
    tip.add(step.clampLength(0, maxSpeed * seconds));
  }
}
