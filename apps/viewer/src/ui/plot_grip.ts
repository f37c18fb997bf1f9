// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId } from './dom';
import { TimePlot } from './plot';
import { readStored, store } from './stored';

const key = 'plot-height';
const minHeight = 90; // [CSS pixels]
const maxShare = 0.6; // of the window: the scene stays in sight
const defaultShare = 0.28; // of the window
const keyStep = 20; // [CSS pixels]

/// The upper edge of the plots: dragged, or with the arrow keys, it sets their height; a double
/// click sets the first height again. The height is kept for the next visit.
export class PlotGrip {
  private readonly grip = byId('plot-grip', HTMLDivElement);
  private chosen = Number(readStored(key)) || NaN; // [CSS pixels] NaN: by the window
  private pressed = { at: NaN, height: NaN }; // [CSS pixels]

  constructor() {
    const { grip } = this;
    grip.hidden = false;
    grip.addEventListener('pointerdown', (event) => this.press(event));
    grip.addEventListener('pointermove', (event) => {
      const { at, height } = this.pressed;
      if (grip.hasPointerCapture(event.pointerId)) this.choose(height + at - event.clientY);
    });
    grip.addEventListener('dblclick', () => this.choose(NaN));
    grip.addEventListener('keydown', (event) => this.pressKey(event));
    window.addEventListener('resize', () => this.show());
    this.show();
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.grip.setPointerCapture(event.pointerId);
    this.pressed = { at: event.clientY, height: this.height };
  }

  private pressKey(event: KeyboardEvent): void {
    const heights: Record<string, number> = {
      ArrowUp: this.height + keyStep,
      ArrowDown: this.height - keyStep,
      Home: minHeight,
      End: this.maxHeight,
    };
    const height = heights[event.key];
    if (height === undefined) return;
    event.preventDefault();
    this.choose(height);
  }

  private choose(height: number): void {
    this.chosen = Number.isFinite(height) ? this.limited(height) : NaN;
    store(key, Number.isFinite(this.chosen) ? String(this.chosen) : '');
    this.show();
  }

  private get height(): number {
    const height = Number.isFinite(this.chosen) ? this.chosen : defaultShare * innerHeight;
    return Math.round(this.limited(height));
  }

  private get maxHeight(): number {
    return Math.max(minHeight, Math.round(maxShare * innerHeight));
  }

  private limited(height: number): number {
    return Math.min(Math.max(height, minHeight), this.maxHeight);
  }

  private show(): void {
    const { grip, height, maxHeight } = this;
    TimePlot.setHeight(height);
    const values = { valuenow: height, valuemin: minHeight, valuemax: maxHeight };
    for (const [name, value] of Object.entries(values))
      grip.setAttribute(`aria-${name}`, String(value));
  }
}
