// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from './dom';

const minDrag = 5; // [CSS pixels] less is a click

interface Actions {
  point: (share: number | null) => void; // null: the pointer has left
  seek: (share: number) => void;
  zoom: (from: number, to: number) => void;
  showAll: () => void;
}

/// What the pointer does over a plot, in shares of the time axis: a click seeks, a drag zooms, a
/// double click shows all.
export class PlotPointer {
  private readonly selection = create('div', { className: 'selection', hidden: true });
  private pressedAt: number | null = null; // [CSS pixels]

  constructor(
    private readonly over: HTMLElement,
    private readonly actions: Actions,
  ) {
    over.append(this.selection);
    over.addEventListener('pointermove', (event) => this.move(this.xOf(event)));
    over.addEventListener('pointerleave', () => actions.point(null));
    over.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      this.pressedAt = this.xOf(event);
    });
    over.addEventListener('pointerup', (event) => this.release(this.xOf(event)));
    over.addEventListener('pointercancel', () => this.end());
    over.addEventListener('dblclick', () => actions.showAll());
  }

  private xOf(event: PointerEvent): number {
    const { left, width } = this.over.getBoundingClientRect();
    return Math.min(Math.max(event.clientX - left, 0), width);
  }

  private share(x: number): number {
    return x / Math.max(1, this.over.clientWidth);
  }

  private move(x: number): void {
    this.actions.point(this.share(x));
    const from = this.pressedAt;
    this.selection.hidden = from === null || Math.abs(x - from) < minDrag;
    if (from === null) return;
    this.selection.style.left = `${Math.min(x, from)}px`;
    this.selection.style.width = `${Math.abs(x - from)}px`;
  }

  private release(x: number): void {
    const from = this.pressedAt;
    this.end();
    if (from === null) return;
    if (Math.abs(x - from) < minDrag) return this.actions.seek(this.share(x));
    this.actions.zoom(this.share(Math.min(x, from)), this.share(Math.max(x, from)));
  }

  private end(): void {
    this.pressedAt = null;
    this.selection.hidden = true;
  }
}
