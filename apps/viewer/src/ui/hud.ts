// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';
import type { Session } from '../session/session';
import { byId, fillList, setText } from './dom';
import { microseconds, milliseconds } from './format';

/// How fresh the picture is, and where the time goes.
export class Hud {
  private readonly box = byId('hud', HTMLDetailsElement);
  private readonly line = byId('hud-line', HTMLElement);
  private readonly list = byId('hud-list', HTMLElement);

  constructor(private readonly session: Session) {}

  /// To be called a few times a second: faster, nobody can read it.
  update(): void {
    const state = this.session.latest();
    this.box.hidden = this.session.welcome === null;
    const figures = this.session.figures();
    if (!state) return setText(this.line, 'no state');
    const hand = figures.commandToDrawn;
    const parts = [`${figures.stateRate} Hz`, `${milliseconds(figures.age)} old`];
    if (Number.isFinite(hand)) parts.push(`hand to picture ${milliseconds(hand)}`);
    if (state.isOnHold) parts.push('on hold');
    setText(this.line, parts.join(' · '));
    if (this.box.open) fillList(this.list, this.rows(state));
  }

  private rows(state: LiveState): [string, string][] {
    const figures = this.session.figures();
    const { median, p99, longest } = state.cycleTime;
    return [
      ['States', `${figures.stateRate} Hz, ${this.session.skipped} skipped`],
      ['Pictures', `${figures.drawRate} Hz`],
      ['Age of the newest state', milliseconds(figures.age)],
      ['Command to world', milliseconds(figures.commandToWorld)],
      ['World to page', milliseconds(figures.worldToPage)],
      ['Page to picture', milliseconds(figures.pageToPicture)],
      ['Command to picture, in all', milliseconds(figures.commandToDrawn)],
      ['In the send queue', milliseconds(state.age.queue)],
      ['World cycle, median', microseconds(median)],
      ['World cycle, 99 %', microseconds(p99)],
      ['World cycle, longest', microseconds(longest)],
      ['Late cycles', `${state.lateCycles} of ${state.cycles.toLocaleString('en')}`],
      ['Pulses', String(state.pulses)],
    ];
  }
}
