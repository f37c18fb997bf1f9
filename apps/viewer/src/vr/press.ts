// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// A button, or what counts as one: a pinch, a stick, a fingertip. It begins at one bound and ends at
/// another, so that a hand that trembles at the bound presses once.
export class Press {
  private down = false;

  get isDown(): boolean {
    return this.down;
  }

  /// Once a frame: whether it is past the bound to begin, and still within the one to last. True in
  /// the frame in which it begins.
  update(begins: boolean, lasts = begins): boolean {
    const was = this.down;
    this.down = begins || (was && lasts);
    return this.down && !was;
  }
}
