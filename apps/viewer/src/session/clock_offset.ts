// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

const kept = 16; // pings: clocks of one machine or of two drift little within as many seconds

/// By how much the server's clock is ahead of the page's, from pings: the quickest one of the last
/// few tells best, as neither way can have taken long.
export class ClockOffset {
  private samples: { roundTrip: number; offset: number }[] = [];

  /// Page's clocks when the ping went and its pong came, the server's in between [s].
  add(sent: number, received: number, server: number): void {
    this.samples.push({ roundTrip: received - sent, offset: server - (sent + received) / 2 });
    if (this.samples.length > kept) this.samples.shift();
  }

  /// [s], NaN before the first pong.
  seconds(): number {
    let best = { roundTrip: Infinity, offset: NaN };
    for (const sample of this.samples) if (sample.roundTrip < best.roundTrip) best = sample;
    return best.offset;
  }
}
