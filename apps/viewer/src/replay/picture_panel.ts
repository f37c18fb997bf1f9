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
  private isLoading = false;

  constructor(private readonly times: readonly number[]) {
    this.toggle.hidden = times.length === 0;
    this.toggle.addEventListener('click', () => this.show(this.figure.hidden));
    this.image.addEventListener('load', () => this.arrived(this.image.dataset.frame));
    this.image.addEventListener('error', () => this.arrived(undefined));
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
    if (this.isLoading || this.figure.hidden || this.wanted < 0 || this.wanted === this.shown)
      return;
    this.isLoading = true;
    this.image.dataset.frame = String(this.wanted);
    this.image.src = `/api/frames/${this.wanted}.jpg`;
  }

  private arrived(frame: string | undefined): void {
    this.isLoading = false;
    this.shown = frame === undefined ? this.wanted : Number(frame);
    const time = this.times[this.shown]?.toFixed(2);
    setText(
      this.caption,
      frame === undefined ? `no picture at ${time} s` : `Recorded at ${time} s, prediction over it`,
    );
    this.load();
  }
}
