// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { eventColors } from '../palette';
import { byId, create, setText } from '../ui/dom';
import { shape } from '../ui/svg';
import { eventBeside, eventKinds, type EventKind, type ReplayEvent } from './events';

const rowHeight = 6; // [CSS pixels]
const shownSeconds = 0.5; // about its time, the name of the event that was jumped to is shown

/// The events under the time line, a row of marks for each kind, and the jumps from one to the next.
export class EventMarks {
  private readonly kind = byId('event-kind', HTMLSelectElement);
  private readonly name = byId('event', HTMLOutputElement);
  private shown: ReplayEvent | null = null;

  /// `onJump` shows the time of an event.
  constructor(
    private readonly events: readonly ReplayEvent[],
    duration: number,
    private readonly onJump: (time: number) => void,
  ) {
    const present = eventKinds.filter((kind) => events.some((event) => event.kind === kind));
    byId('event-jumps', HTMLSpanElement).hidden = present.length === 0;
    this.kind.append(
      create('option', { value: '', textContent: 'all events' }),
      ...present.map((kind) => create('option', { value: kind, textContent: `${kind}s` })),
    );
    byId('event-keys', HTMLSpanElement).append(...present.map(keyOf));
    if (duration > 0) byId('event-marks', HTMLDivElement).append(this.draw(present, duration));
  }

  private draw(kinds: readonly EventKind[], duration: number): SVGElement {
    const height = rowHeight * kinds.length;
    const marks = kinds.map((kind, row) => {
      const d = this.events
        .filter((event) => event.kind === kind)
        .map(({ time }) => `M${(1000 * time) / duration},${row * rowHeight}v${rowHeight - 1}`)
        .join('');
      const line = { 'stroke-width': 2, 'vector-effect': 'non-scaling-stroke' };
      return shape('path', { d, stroke: eventColors[kind], 'data-mark': kind, ...line });
    });
    const size = { viewBox: `0 0 1000 ${height}`, preserveAspectRatio: 'none', height };
    return shape('svg', size, ...marks);
  }

  /// To the next event (1) or the one before (-1) of `time`.
  jump(time: number, direction: 1 | -1): void {
    const chosen = this.kind.value;
    const events = this.events.filter(({ kind }) => chosen === '' || kind === chosen);
    const event = eventBeside(events, time, direction);
    if (!event) return setText(this.name, direction > 0 ? 'no later event' : 'no earlier event');
    this.shown = event;
    this.onJump(event.time);
    setText(this.name, event.text);
  }

  update(time: number): void {
    if (this.shown && Math.abs(this.shown.time - time) <= shownSeconds) return;
    this.shown = null;
    setText(this.name, '');
  }
}

function keyOf(kind: EventKind): HTMLElement {
  const key = create('span', { className: 'key area', textContent: kind });
  key.style.setProperty('--key', eventColors[kind]);
  return key;
}
