// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Phase } from '../protocol';
import type { Replay, ReplayModel, ReplayObject } from './replay_data';

export const eventKinds = ['contact', 'breakaway', 'correction'] as const;
export type EventKind = (typeof eventKinds)[number];

export interface ReplayEvent {
  time: number; // [s] from the start
  kind: EventKind;
  object: string;
  text: string;
}

const sameInstant = 1e-3; // [s] a jump goes beyond what is at the present time

/// All contacts, breakaways and corrections, in the order of time.
export function eventsOf({ model, objects }: Replay): ReplayEvent[] {
  return [...objects.flatMap(eventsOfObject), ...model.corrections.map(correctionEvent)].sort(
    (a, b) => a.time - b.time,
  );
}

/// By the measured phases; where no contact was measured, by the predicted ones.
function eventsOfObject({ name, phases }: Pick<ReplayObject, 'name' | 'phases'>): ReplayEvent[] {
  const isMeasured = phases.some(({ measured }) => measured !== 'free');
  const events: ReplayEvent[] = [];
  let before: Phase = 'free';
  for (const { t, measured, predicted } of phases) {
    const phase = isMeasured ? measured : predicted;
    if (before === 'free' && phase !== 'free') events.push(eventAt(t, 'contact', 'with', name));
    if (before !== 'sliding' && phase === 'sliding')
      events.push(eventAt(t, 'breakaway', 'of', name));
    before = phase;
  }
  return events;
}

function correctionEvent({ t, object, what }: ReplayModel['corrections'][number]): ReplayEvent {
  const event = eventAt(t, 'correction', 'of', object);
  return what.endsWith('+lost') ? { ...event, text: `${event.text}, lost` } : event;
}

function eventAt(time: number, kind: EventKind, word: string, object: string): ReplayEvent {
  return { time, kind, object, text: `${kind} ${word} ${object}` };
}

/// The nearest event after `time` (direction 1), or before it (-1).
export function eventBeside(
  events: readonly ReplayEvent[],
  time: number,
  direction: 1 | -1,
): ReplayEvent | undefined {
  return direction > 0
    ? events.find((event) => event.time > time + sameInstant)
    : events.filter((event) => event.time < time - sameInstant).at(-1);
}
