// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// A button with hysteresis (Schmitt trigger), also for a pinch, a stick or a fingertip: tremor at
/// one threshold does not press twice.
export class Press {
  private down = false;

  get isDown(): boolean {
    return this.down;
  }

  /// Once a frame: whether the input is beyond the on threshold, and beyond the off threshold. True
  /// on the rising edge.
  update(isOn: boolean, isNotOff = isOn): boolean {
    const was = this.down;
    this.down = isOn || (was && isNotOff);
    return this.down && !was;
  }
}
