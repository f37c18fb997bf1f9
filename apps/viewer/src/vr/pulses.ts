// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// What a controller can do to a hand; absent on hands.
export interface Actuator {
  pulse(intensity: number, milliseconds: number): unknown;
}

/// What of the world's state is to be felt.
export interface Felt {
  /// 0 to 1: what a controller should give now.
  pulse: number;
  /// Grows by one at each breakaway and each first touch.
  pulses: number;
}

// A touch is felt as one when it is over before the next frame's rumble: 25 ms, about two frames.
const crispMs = 25;
// A rumble outlasts the wait for the next one, so that it does not stutter [ms].
const rumbleMs = 40;
const everyMs = 30;
// Below this a motor only hums.
const minPulse = 0.02;

/// Gives the world's pulses to a hand: one crisp pulse an event, and a rumble in between.
export class Pulses {
  private seen: number | undefined;
  private quietUntil = 0;

  /// Once a frame, at `now` [ms]. Without an actuator, events pass unfelt rather than pile up.
  update(now: number, felt: Felt, actuator: Actuator | undefined): void {
    const isEvent = this.seen !== undefined && felt.pulses > this.seen;
    this.seen = felt.pulses;
    if (actuator === undefined) return;
    if (isEvent) {
      actuator.pulse(1, crispMs);
      this.quietUntil = now + crispMs;
    } else if (felt.pulse > minPulse && now >= this.quietUntil) {
      actuator.pulse(Math.min(felt.pulse, 1), rumbleMs);
      this.quietUntil = now + everyMs;
    }
  }

  /// Forgets what was counted: what was while nobody held it is not felt later.
  reset(): void {
    this.seen = undefined;
    this.quietUntil = 0;
  }
}
