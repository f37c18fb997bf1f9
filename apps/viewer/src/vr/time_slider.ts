// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Playback } from '../replay/playback';

// In pixels of the panel, from its upper left corner.
const left = 24;
const right = 488;
const top = 176;
const bottom = 224;
const reach = 16; // [px] beside the bar, so that both of its ends can be touched

/// The bar of a replay's time on the panel.
export const timeSlider = {
  /// The time [s] at a place on the panel; undefined beside the bar.
  timeAt(x: number, y: number, duration: number): number | undefined {
    if (y < top || y > bottom || x < left - reach || x > right + reach) return undefined;
    return (Math.min(Math.max((x - left) / (right - left), 0), 1) || 0) * duration;
  },

  /// Where the bar has a time.
  placeOf(time: number, duration: number): { x: number; y: number } {
    const share = duration > 0 ? time / duration : 0;
    return { x: left + share * (right - left), y: (top + bottom) / 2 };
  },

  draw(pen: CanvasRenderingContext2D, { time, duration }: Playback): void {
    const { x, y } = this.placeOf(time, duration);
    pen.fillStyle = '#24425c';
    pen.fillRect(left, y - 8, right - left, 16);
    pen.fillStyle = '#ff8a1f';
    pen.fillRect(left, y - 8, x - left, 16);
    pen.beginPath();
    pen.arc(x, y, 20, 0, 2 * Math.PI);
    pen.fill();
  },
};
