// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';
import type { Session } from '../session/session';
import { byId, fillList, setText } from './dom';
import { microseconds, milliseconds } from './format';

const shownDelay = 0.05; // [s]

/// Shows rates, state age and the latency by stages.
export class Hud {
  private readonly box = byId('hud', HTMLDetailsElement);
  private readonly line = byId('hud-line', HTMLElement);
  private readonly list = byId('hud-list', HTMLElement);

  constructor(
    private readonly session: Session,
    /// Further rows: of the link.
    private readonly more: () => readonly (readonly [string, string])[] = () => [],
  ) {}

  /// To be called a few times a second, so that the text can be read.
  update(): void {
    const state = this.session.latest();
    this.box.hidden = this.session.welcome === null;
    const stats = this.session.latencyStats();
    if (!state) return setText(this.line, 'no state');
    const latency = stats.commandToDrawn;
    const parts = [`${stats.stateRate} Hz`, `state age ${milliseconds(stats.age)}`];
    if (Number.isFinite(latency)) parts.push(`latency ${milliseconds(latency)}`);
    const { toolDelay } = this.session;
    if (toolDelay > shownDelay)
      parts.push(`slow picture: the tool follows ${milliseconds(toolDelay)} late`);
    if (state.timeScale < 1) parts.push(`time × ${state.timeScale}`);
    if (state.isStopped) parts.push('emergency stop');
    if (state.isOnHold) parts.push('on hold');
    setText(this.line, parts.join(' · '));
    if (this.box.open) fillList(this.list, [...this.rows(state), ...this.more()]);
  }

  private rows(state: LiveState): [string, string][] {
    const stats = this.session.latencyStats();
    const { median, p99, longest } = state.cycleTime;
    return [
      ['States', `${stats.stateRate} Hz, ${this.session.skipped} skipped`],
      ['Frames drawn', `${stats.drawRate} Hz`],
      ['State age', milliseconds(stats.age)],
      ['Command to world', milliseconds(stats.commandToWorld)],
      ['World to page', milliseconds(stats.worldToPage)],
      ['Page to drawn frame', milliseconds(stats.pageToDrawn)],
      ['Command to drawn frame, total', milliseconds(stats.commandToDrawn)],
      ['Time in the send queue', milliseconds(state.age.queue)],
      ['World cycle, median', microseconds(median)],
      ['World cycle, 99th percentile', microseconds(p99)],
      ['World cycle, maximum', microseconds(longest)],
      ['Late cycles', `${state.lateCycles} of ${state.cycles.toLocaleString('en')}`],
      ['Haptic pulses', String(state.pulses)],
    ];
  }
}
