// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, setPressed, setText } from '../ui/dom';
import { indexAt } from './replay_data';

/// The recorded image at the timeline's time. One request at a time, the next for the newest time.
export class PicturePanel {
  shown = -1;
  private readonly figure = byId('picture', HTMLElement);
  private readonly image = this.figure.querySelector('img')!;
  private readonly caption = this.figure.querySelector<HTMLElement>('.caption')!;
  private readonly toggle = byId('picture-toggle', HTMLButtonElement);
  private wanted = -1;
  private loading = -1;

  constructor(private readonly times: readonly number[]) {
    this.toggle.hidden = times.length === 0;
    this.toggle.addEventListener('click', () => this.show(this.figure.hidden));
    byId('picture-close', HTMLButtonElement).addEventListener('click', () => this.show(false));
    const enlarge = byId('picture-enlarge', HTMLButtonElement);
    enlarge.addEventListener('click', () => {
      const isLarge = this.figure.classList.toggle('large');
      setPressed(enlarge, isLarge);
      setText(enlarge, isLarge ? 'Reduce' : 'Enlarge');
    });
    this.caption.addEventListener('pointerdown', (event) => this.startMove(event));
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

  /// Moves the picture with the pointer, within the stage.
  private startMove(event: PointerEvent): void {
    if (event.button !== 0 || this.figure.classList.contains('large')) return;
    const { figure, caption } = this;
    const stage = figure.parentElement!;
    const from = { x: event.clientX - figure.offsetLeft, y: event.clientY - figure.offsetTop };
    caption.setPointerCapture(event.pointerId);
    const move = ({ clientX, clientY }: PointerEvent) => {
      const within = (value: number, max: number) => Math.min(Math.max(value, 0), Math.max(max, 0));
      const left = within(clientX - from.x, stage.clientWidth - figure.offsetWidth);
      const top = within(clientY - from.y, stage.clientHeight - figure.offsetHeight);
      Object.assign(figure.style, {
        left: `${left}px`,
        top: `${top}px`,
        right: 'auto',
        bottom: 'auto',
      });
    };
    caption.addEventListener('pointermove', move);
    const end = () => caption.removeEventListener('pointermove', move);
    caption.addEventListener('lostpointercapture', end, { once: true });
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
