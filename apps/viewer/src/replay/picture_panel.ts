// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { addressOf } from '../page_files';
import { byId } from '../ui/dom';
import { PictureFigure } from '../ui/picture_figure';
import { indexAt } from './replay_data';

/// The recorded image at the timeline's time. One request at a time, the next for the newest time.
export class PicturePanel {
  shown = -1;
  private readonly figure: PictureFigure;
  private wanted = -1;
  private loading = -1;

  constructor(private readonly times: readonly number[]) {
    const toggle = byId('picture-toggle', HTMLButtonElement);
    toggle.hidden = times.length === 0;
    const description = 'Recorded colour image with the predicted bodies overlaid';
    this.figure = new PictureFigure(toggle, description, () => this.load());
    this.figure.image.addEventListener('load', () => this.finish(true));
    this.figure.image.addEventListener('error', () => this.finish(false));
  }

  show(isShown: boolean): void {
    this.figure.show(isShown);
  }

  setTime(time: number): void {
    this.wanted = indexAt(this.times, time);
    this.load();
  }

  private load(): void {
    const isNew = this.wanted >= 0 && this.wanted !== this.shown;
    if (this.loading >= 0 || !this.figure.isShown || !isNew) return;
    this.loading = this.wanted;
    this.figure.image.src = addressOf(`/api/frames/${this.loading}.jpg`);
  }

  private finish(isLoaded: boolean): void {
    this.shown = this.loading;
    this.loading = -1;
    const time = this.times[this.shown]?.toFixed(2);
    this.figure.setCaption(
      isLoaded ? `Recorded at ${time} s, with predicted bodies` : `no image at ${time} s`,
    );
    this.load();
  }
}
