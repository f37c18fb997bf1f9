// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId } from './dom';

const minPull = 24; // [CSS pixels] less is a click

/// The panel: beside the scene, or in a narrow window a sheet that its grip pulls up and down.
export class Sheet {
  private readonly panel = byId('panel', HTMLElement);
  private readonly toggle = byId('panel-toggle', HTMLButtonElement);
  private readonly grip = byId('sheet-grip', HTMLButtonElement);
  private readonly narrow = matchMedia('(width <= 720px)');
  private pressedAt = NaN; // [CSS pixels]
  private wasPulled = false;

  constructor() {
    this.toggle.addEventListener('click', () => this.show(this.panel.hidden));
    this.grip.addEventListener('click', () => {
      if (!this.wasPulled) this.show(this.panel.hidden);
      this.wasPulled = false;
    });
    this.grip.addEventListener('pointerdown', (event) => {
      this.grip.setPointerCapture(event.pointerId);
      this.pressedAt = event.clientY;
    });
    this.grip.addEventListener('pointerup', (event) => {
      const up = this.pressedAt - event.clientY;
      this.wasPulled = Math.abs(up) >= minPull;
      if (this.wasPulled) this.show(up > 0);
    });
    this.narrow.addEventListener('change', () => this.show(!this.narrow.matches));
    this.show(!this.narrow.matches);
  }

  private show(isShown: boolean): void {
    this.panel.hidden = !isShown;
    for (const button of [this.toggle, this.grip])
      button.setAttribute('aria-expanded', String(isShown));
  }
}
