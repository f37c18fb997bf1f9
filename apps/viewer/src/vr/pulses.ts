// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// A controller's vibration motor (WebXR haptic actuator); hands have none.
export interface Actuator {
  pulse(intensity: number, milliseconds: number): unknown;
}

/// The part of a state that is rendered as vibration.
export interface HapticCue {
  /// 0 to 1: the current vibration intensity.
  pulse: number;
  /// Event counter: breakaways and first contacts.
  pulses: number;
}

// Of one event: short enough to be distinct from the rumble, about two frames [ms].
const eventPulseMs = 25;
// A rumble pulse is longer than the period, so that the vibration is continuous [ms].
const rumbleMs = 40;
const rumblePeriodMs = 30;
// Below this intensity a motor only hums.
const minPulse = 0.02;

/// Renders haptic cues on a controller: one short pulse per event, and a rumble in between.
export class Pulses {
  private lastCount: number | undefined;
  private busyUntil = 0; // [ms]

  /// Once a frame, at `now` [ms]. Without an actuator events are dropped, not queued.
  update(now: number, cue: HapticCue, actuator: Actuator | undefined): void {
    const isEvent = this.lastCount !== undefined && cue.pulses > this.lastCount;
    this.lastCount = cue.pulses;
    if (actuator === undefined) return;
    if (isEvent) {
      actuator.pulse(1, eventPulseMs);
      this.busyUntil = now + eventPulseMs;
    } else if (cue.pulse > minPulse && now >= this.busyUntil) {
      actuator.pulse(Math.min(cue.pulse, 1), rumbleMs);
      this.busyUntil = now + rumblePeriodMs;
    }
  }

  /// Clears the event count, so that events before a session are not rendered in it.
  reset(): void {
    this.lastCount = undefined;
    this.busyUntil = 0;
  }
}
