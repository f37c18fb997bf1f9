// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

export const speeds = [0.1, 0.25, 0.5, 1, 2, 4] as const;

/// The playback position of a replay, in seconds from its start.
export class Timeline {
  time = 0;
  speed = 1;
  isPlaying = false;

  constructor(readonly duration: number) {}

  /// Advances by `seconds` of wall time; stops at the end. True if the position changed.
  advance(seconds: number): boolean {
    if (!this.isPlaying) return false;
    this.seek(this.time + seconds * this.speed);
    if (this.time >= this.duration) this.isPlaying = false;
    return true;
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(Number.isFinite(time) ? time : 0, 0), this.duration);
  }

  /// Play or pause; from the end it restarts.
  toggle(): void {
    if (!this.isPlaying && this.time >= this.duration) this.time = 0;
    this.isPlaying = !this.isPlaying;
  }
}
