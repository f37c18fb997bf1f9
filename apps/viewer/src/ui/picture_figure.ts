// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, setPressed, setText } from './dom';

/// A camera's picture over a corner of the scene, which can be moved, enlarged and closed.
export class PictureFigure {
  readonly image: HTMLImageElement;
  private readonly figure = byId('picture', HTMLElement);
  private readonly caption = this.figure.querySelector<HTMLElement>('.caption')!;

  /// `toggle` opens and closes it; `description` is the image's alternative text.
  constructor(
    private readonly toggle: HTMLButtonElement,
    description: string,
    private readonly onShown: () => void,
  ) {
    this.image = this.figure.querySelector('img')!;
    this.image.alt = description;
    toggle.addEventListener('click', () => this.show(!this.isShown));
    byId('picture-close', HTMLButtonElement).addEventListener('click', () => this.show(false));
    const enlarge = byId('picture-enlarge', HTMLButtonElement);
    enlarge.addEventListener('click', () => {
      const isLarge = this.figure.classList.toggle('large');
      setPressed(enlarge, isLarge);
      setText(enlarge, isLarge ? 'Reduce' : 'Enlarge');
    });
    this.caption.addEventListener('pointerdown', (event) => this.startMove(event));
  }

  get isShown(): boolean {
    return !this.figure.hidden;
  }

  show(isShown: boolean): void {
    this.figure.hidden = !isShown;
    setPressed(this.toggle, isShown);
    this.onShown();
  }

  setCaption(text: string): void {
    setText(this.caption, text);
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
}
