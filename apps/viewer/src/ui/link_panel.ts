// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import './link_panel.css';
import type { App } from '../app';
import type { LinkInfo } from '../link_protocol';
import { Command, type LiveState } from '../protocol';
import { pageClock } from '../session/clock';
import { byId, create, setText } from './dom';
import { milliseconds } from './format';
import { linkStages, stageNames } from './link_delays';

const limitNames = ['workspace', 'step', 'speed', 'acceleration', 'force'];
const unusualLimits = 0b10011; // this page's tool keeps to the others anyway
const stopKey = 'KeyX';

/// The emergency stop, in the header and on a key; and of an operator's site the link's state, with
/// an alert while the robot holds because the link is silent.
export class LinkPanel {
  private readonly stop = create('button', {
    id: 'emergency-stop',
    type: 'button',
    textContent: 'Stop (X)',
    title: 'Emergency stop, on all pages and at the robot. Key X. Only its release ends it.',
  });
  private readonly line = create('output', { id: 'link-line', hidden: true });
  private readonly release = create('button', {
    id: 'release-stop',
    type: 'button',
    textContent: 'Release the stop',
  });
  private readonly title = create('strong');
  private readonly text = create('span');
  private readonly alert = create('div', { id: 'link-alert', hidden: true });
  private stages: number[] | null = null;
  /// Whether this is an operator's site without a link to the robot's.
  isLost = false;

  constructor(
    private readonly app: App,
    private readonly disengage: () => void,
  ) {
    this.alert.setAttribute('role', 'alert');
    this.alert.append(this.title, this.text, this.release);
    byId('status-lines', HTMLDivElement).append(this.line, this.alert);
    byId('actions', HTMLDivElement).append(this.stop);
    this.stop.addEventListener('click', () => this.stopNow());
    this.release.addEventListener('click', () => app.session.command(Command.releaseStop));
    window.addEventListener('keydown', (event) => {
      const isTyping = event.target instanceof HTMLInputElement;
      if (event.code === stopKey && !event.repeat && !isTyping) this.stopNow();
    });
  }

  /// The stages of the newest command's way [s]; null without a link.
  delays(): readonly (readonly [string, string])[] {
    const { stages } = this;
    if (!stages) return [];
    const total = stages.reduce((sum, stage) => sum + stage, 0);
    return [
      ...stageNames.map((name, i) => [name, milliseconds(stages[i])] as const),
      ['Hand to drawn effect, total', milliseconds(total)] as const,
    ];
  }

  /// Once a frame, drawn or not; whether isLost has changed.
  update(): boolean {
    const state = this.app.session.latest();
    const wasLost = this.isLost;
    this.isLost = state?.link ? !state.link.isConnected : false;
    this.show(state);
    return this.isLost !== wasLost;
  }

  private show(state: LiveState | null): void {
    this.stop.disabled = !state;
    const link = state?.link ?? null;
    this.showAlert(state);
    this.line.hidden = !link || !this.alert.hidden;
    if (!link || this.line.hidden) return;
    setText(this.line, lineText(link));
    const isLimited = ((link.robot?.limits ?? 0) & unusualLimits) !== 0;
    this.line.classList.toggle('warning', isLimited);
  }

  /// Once a drawn frame.
  drawn(): void {
    const stamps = this.app.session.latest()?.link?.stamps;
    if (!stamps) return void (this.stages = null);
    this.stages = linkStages(stamps, this.app.session.latency.offset(), pageClock()) ?? this.stages;
  }

  private stopNow(): void {
    this.disengage();
    this.app.session.command(Command.emergencyStop);
  }

  private showAlert(state: LiveState | null): void {
    this.alert.hidden = !state || (!state.isStopped && !this.isLost);
    this.release.hidden = !state?.isStopped;
    if (this.alert.hidden) return;
    setText(this.title, state?.isStopped ? 'Emergency stop' : "No link to the robot's site");
    const silence = state?.link?.silence ?? 0;
    setText(
      this.text,
      state?.isStopped
        ? 'The tool stays where it is; after the release, on hold.'
        : `silent for ${silence.toFixed(1)} s: it holds, the clutch is open. Connecting again…`,
    );
  }
}

function lineText(link: LinkInfo): string {
  const parts = [`robot ${milliseconds(link.lead)} behind`];
  parts.push(`round trip ${milliseconds(link.roundTrip)}`);
  parts.push(`corrections ${link.robot?.corrections ?? 0}`);
  if (link.robot?.isOnHold) parts.push('robot on hold');
  const limits = limitNames.filter((_, i) => ((link.robot?.limits ?? 0) >> i) & 1);
  if (limits.length > 0) parts.push(`limit: ${limits.join(', ')}`);
  return parts.join(' · ');
}
