// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Whether the tool follows the hand: only while the person holds it, and only while the hand can be
/// trusted. Opened by anything but the person, it closes again only after they let go and take hold
/// anew, so that nothing moves because a headset was put back on.
export class Clutch {
  private closed = false;
  private waitsForRelease = false;
  private reason = '';

  get isClosed(): boolean {
    return this.closed;
  }

  /// Why it is open against the person's wish; empty after they let go.
  get openedBecause(): string {
    return this.reason;
  }

  /// Once a frame: what the person does, and why the hand is not to be trusted (empty: it is).
  update(isHeld: boolean, doubt: string): boolean {
    if (doubt !== '') {
      this.open(doubt);
      if (isHeld) this.reason = doubt;
    } else if (!isHeld) {
      this.closed = false;
      this.waitsForRelease = false;
      this.reason = '';
    } else if (!this.waitsForRelease) {
      this.closed = true;
    }
    return this.closed;
  }

  /// Opens at once.
  open(reason: string): void {
    if (this.closed) this.reason = reason;
    this.closed = false;
    this.waitsForRelease = true;
  }
}
