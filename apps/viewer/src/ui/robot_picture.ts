// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LinkInfo } from '../link_protocol';
import { byId, create } from './dom';
import { PictureFigure } from './picture_figure';

const longAge = 2; // [s] of a picture that no longer shows what happens
// A smaller window would have the picture over what is pushed: there it opens on request.
const hasRoom = '(min-width: 1000px) and (min-height: 600px)';

/// What the robot's camera sees, with its age, at an operator's site. One request at a time, the
/// next for the newest picture.
export class RobotPicture {
  private readonly toggle = create('button', {
    id: 'camera-toggle',
    type: 'button',
    textContent: 'Camera',
    title: "Shows or hides the picture of the robot's camera.",
    hidden: true,
  });
  private readonly figure: PictureFigure;
  private newest = 0;
  private shown = 0;
  private loading = 0;
  private age = 0; // [s] of the newest one
  private ageShown = ''; // that of the caption

  constructor() {
    byId('actions', HTMLDivElement).append(this.toggle);
    const description = "What the robot's camera saw last";
    this.figure = new PictureFigure(this.toggle, description, () => this.load());
    this.figure.image.addEventListener('load', () => this.finish());
    this.figure.image.addEventListener('error', () => this.finish());
  }

  /// Once a frame.
  update(link: LinkInfo | null): void {
    if (!link || link.picture === 0) return;
    this.newest = link.picture;
    this.age = link.pictureAge;
    if (this.toggle.hidden) {
      this.toggle.hidden = false;
      if (matchMedia(hasRoom).matches) this.figure.show(true);
    }
    this.load();
    this.showAge();
  }

  private load(): void {
    const isNew = this.newest !== this.shown;
    if (this.loading > 0 || !this.figure.isShown || !isNew) return;
    this.loading = this.newest;
    this.figure.image.src = `/api/robot/${this.loading}.jpg`;
  }

  private finish(): void {
    this.shown = this.loading;
    this.loading = 0;
    this.load();
  }

  private showAge(): void {
    const age = `${this.age.toFixed(1)} s`;
    if (age === this.ageShown) return;
    this.ageShown = age;
    const isOld = this.age > longAge;
    this.figure.setCaption(`Robot's camera, ${age} ago${isOld ? ': no newer picture' : ''}`);
  }
}
