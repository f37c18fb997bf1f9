// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, create, setText } from '../ui/dom';
import { EventMarks } from './event_marks';
import type { ReplayEvent } from './events';
import { speeds, type Timeline } from './timeline';

const smallStep = 0.1; // [s]
const largeStep = 1; // [s]

/// Play, pause, seek, jumps to events and speed, by mouse and keyboard.
export class TimelineBar {
  private readonly play = byId('play', HTMLButtonElement);
  private readonly scrub = byId('scrub', HTMLInputElement);
  private readonly clock = byId('clock', HTMLSpanElement);
  private readonly speed = byId('speed', HTMLSelectElement);
  private readonly events: EventMarks;

  constructor(
    private readonly timeline: Timeline,
    events: readonly ReplayEvent[],
    canvas: HTMLCanvasElement,
    private readonly onChange: () => void,
  ) {
    byId('timeline', HTMLDivElement).hidden = false;
    this.scrub.max = String(timeline.duration);
    this.events = new EventMarks(events, timeline.duration, (time) => this.stopAt(time));
    byId('next-event', HTMLButtonElement).addEventListener('click', () => this.jump(1));
    byId('previous-event', HTMLButtonElement).addEventListener('click', () => this.jump(-1));
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

  /// To the next event (1), or the one before (-1).
  private jump(direction: 1 | -1): void {
    this.events.jump(this.timeline.time, direction);
  }

  private stopAt(time: number): void {
    this.timeline.isPlaying = false;
    this.seek(time);
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
    this.events.update(time);
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
      KeyN: () => this.jump(1),
      KeyP: () => this.jump(-1),
    };
    const action = actions[event.code];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  }
}
