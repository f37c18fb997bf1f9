// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

const maxSamples = 16; // one ping a second: clock drift is negligible over as many seconds

/// The offset of the server's clock from the page's, estimated as in NTP: of the last pings, the
/// one with the shortest round trip, whose asymmetry is bounded best.
export class ClockOffset {
  private samples: { roundTrip: number; offset: number }[] = [];

  /// The page's clock at ping and pong, and the server's clock in between [s].
  add(sent: number, received: number, server: number): void {
    this.samples.push({ roundTrip: received - sent, offset: server - (sent + received) / 2 });
    if (this.samples.length > maxSamples) this.samples.shift();
  }

  /// The offset [s]; NaN before the first pong.
  seconds(): number {
    let best = { roundTrip: Infinity, offset: NaN };
    for (const sample of this.samples) if (sample.roundTrip < best.roundTrip) best = sample;
    return best.offset;
  }
}
