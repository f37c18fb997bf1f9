// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, setPressed, setText } from '../ui/dom';
import { indexAt } from './replay_data';

/// The recorded picture of the timeline's time. One is asked for at a time, and then the newest.
export class PicturePanel {
  shown = -1;
  private readonly figure = byId('picture', HTMLElement);
  private readonly image = this.figure.querySelector('img')!;
  private readonly caption = this.figure.querySelector('figcaption')!;
  private readonly toggle = byId('picture-toggle', HTMLButtonElement);
  private wanted = -1;
  private loading = -1;

  constructor(private readonly times: readonly number[]) {
    this.toggle.hidden = times.length === 0;
    this.toggle.addEventListener('click', () => this.show(this.figure.hidden));
    this.image.addEventListener('load', () => this.arrived(true));
    this.image.addEventListener('error', () => this.arrived(false));
  }

  show(isShown: boolean): void {
    this.figure.hidden = !isShown;
    setPressed(this.toggle, isShown);
    this.load();
  }

  setTime(time: number): void {
    this.wanted = indexAt(this.times, time);
    this.load();
  }

  private load(): void {
    if (this.loading >= 0 || this.figure.hidden || this.wanted < 0 || this.wanted === this.shown)
      return;
    this.loading = this.wanted;
    this.image.src = `/api/frames/${this.loading}.jpg`;
  }

  private arrived(isThere: boolean): void {
    this.shown = this.loading;
    this.loading = -1;
    const time = this.times[this.shown]?.toFixed(2);
    setText(
      this.caption,
      isThere ? `Recorded at ${time} s, prediction over it` : `no picture at ${time} s`,
    );
    this.load();
  }
}
