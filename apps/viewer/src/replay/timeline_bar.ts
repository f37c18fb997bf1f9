// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, create, setText } from '../ui/dom';
import { speeds, type Timeline } from './timeline';

const smallStep = 0.1; // [s]
const largeStep = 1; // [s]

/// Play, pause, seek and speed, by mouse and keyboard.
export class TimelineBar {
  private readonly play = byId('play', HTMLButtonElement);
  private readonly scrub = byId('scrub', HTMLInputElement);
  private readonly clock = byId('clock', HTMLSpanElement);
  private readonly speed = byId('speed', HTMLSelectElement);

  constructor(
    private readonly timeline: Timeline,
    canvas: HTMLCanvasElement,
    private readonly onChange: () => void,
  ) {
    byId('timeline', HTMLDivElement).hidden = false;
    this.scrub.max = String(timeline.duration);
    this.play.addEventListener('click', () => this.toggle());
    this.scrub.addEventListener('input', () => this.seek(Number(this.scrub.value)));
    const { speed } = this;
    speed.append(
      ...speeds.map((s) => create('option', { value: String(s), textContent: `${s}×` })),
    );
    speed.value = String(timeline.speed);
    speed.addEventListener('change', () => (timeline.speed = Number(speed.value)));
    canvas.addEventListener('keydown', (event) => this.key(event));
    this.update();
  }

  seek(time: number): void {
    this.timeline.seek(time);
    this.onChange();
  }

  /// The next higher speed; after the highest the lowest.
  nextSpeed(): void {
    const next = speeds.findIndex((speed) => speed > this.timeline.speed);
    this.timeline.speed = speeds[Math.max(0, next)];
    this.speed.value = String(this.timeline.speed);
  }

  update(): void {
    const { time, duration, isPlaying } = this.timeline;
    this.scrub.value = String(time);
    const text = `${time.toFixed(2)} / ${duration.toFixed(2)} s`;
    setText(this.clock, text);
    this.scrub.setAttribute(
      'aria-valuetext',
      `${time.toFixed(1)} of ${duration.toFixed(1)} seconds`,
    );
    setText(this.play, isPlaying ? '❚❚' : '▶');
    this.play.setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
  }

  toggle(): void {
    this.timeline.toggle();
    this.onChange();
  }

  private key(event: KeyboardEvent): void {
    const step = event.shiftKey ? largeStep : smallStep;
    const actions: Record<string, () => void> = {
      Space: () => this.toggle(),
      ArrowLeft: () => this.seek(this.timeline.time - step),
      ArrowRight: () => this.seek(this.timeline.time + step),
      Home: () => this.seek(0),
      End: () => this.seek(this.timeline.duration),
    };
    const action = actions[event.code];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  }
}
