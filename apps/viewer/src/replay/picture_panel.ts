// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, setPressed, setText } from '../ui/dom';
import { indexAt } from './replay_data';

/// The recorded image at the timeline's time. One request at a time, the next for the newest time.
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
    this.image.addEventListener('load', () => this.finish(true));
    this.image.addEventListener('error', () => this.finish(false));
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

  private finish(isLoaded: boolean): void {
    this.shown = this.loading;
    this.loading = -1;
    const time = this.times[this.shown]?.toFixed(2);
    setText(
      this.caption,
      isLoaded ? `Recorded at ${time} s, with predicted bodies` : `no image at ${time} s`,
    );
    this.load();
  }
}
