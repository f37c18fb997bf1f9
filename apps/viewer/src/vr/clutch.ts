// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// The clutch, a dead-man switch: the tool follows the hand only while the button is held and no
/// interlock is active. Opened by an interlock, it closes again only after the button was released
/// and pressed again, so that nothing moves because a headset was put back on.
export class Clutch {
  private closed = false;
  private needsRelease = false;
  private reason = '';

  get isClosed(): boolean {
    return this.closed;
  }

  /// The interlock that opened it while the button was held; empty after a release.
  get openReason(): string {
    return this.reason;
  }

  /// Once a frame: whether the button is held, and the active interlock (empty: none).
  update(isHeld: boolean, interlock: string): boolean {
    if (interlock !== '') {
      this.open(interlock);
      if (isHeld) this.reason = interlock;
    } else if (!isHeld) {
      this.closed = false;
      this.needsRelease = false;
      this.reason = '';
    } else if (!this.needsRelease) {
      this.closed = true;
    }
    return this.closed;
  }

  /// Opens the clutch at once, and requires a release before it closes again.
  open(reason: string): void {
    if (this.closed) this.reason = reason;
    this.closed = false;
    this.needsRelease = true;
  }
}
