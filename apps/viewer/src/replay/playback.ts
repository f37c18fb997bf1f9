// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// What controls a replay; in the headset there are no page controls.
export interface Playback {
  readonly time: number; // [s] from the start
  readonly duration: number; // [s]
  readonly isPlaying: boolean;
  readonly speed: number; // a factor of real time
  toggle(): void; // play or pause
  seek(time: number): void; // clamped to the recording
  nextSpeed(): void;
}
