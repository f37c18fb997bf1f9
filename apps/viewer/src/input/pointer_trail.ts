// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

export interface PointerPosition {
  x: number; // [CSS pixels] in the window
  y: number;
}

/// Where a pointer was at each time. A window that is busy drawing gets its moves late and many at
/// once, with their times.
export class PointerTrail {
  private points: (PointerPosition & { clock: number })[] = [];

  /// Begins where the pointer is pressed.
  start(event: PointerEvent): void {
    this.points = [{ x: event.clientX, y: event.clientY, clock: clockOf(event) }];
  }

  add(event: PointerEvent): void {
    const moves = event.getCoalescedEvents?.() ?? [];
    for (const { clientX, clientY, timeStamp } of moves.length > 0 ? moves : [event])
      this.points.push({ x: clientX, y: clientY, clock: clockOf({ timeStamp }) });
  }

  get newest(): PointerPosition {
    return this.points[this.points.length - 1]!;
  }

  /// The last position up to `clock` [s of the page's clock]; earlier ones are forgotten.
  at(clock: number): PointerPosition {
    const later = this.points.findIndex((point) => point.clock > clock);
    const count = later < 0 ? this.points.length : later;
    this.points.splice(0, Math.max(count - 1, 0));
    return this.points[0]!;
  }
}

/// [s] As the page's clock.
function clockOf({ timeStamp }: { timeStamp: number }): number {
  return (performance.timeOrigin + timeStamp) / 1000;
}
