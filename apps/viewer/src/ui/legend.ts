// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { phaseColors, sourceColors } from '../palette';
import { heightColor } from '../scene/cells';
import { byId, create } from './dom';

const meanings = {
  free: 'not pushed',
  static: 'pushed, friction holds it',
  critical: 'about to slide',
  sliding: 'slides',
} as const;

/// The phases that plots show as bands.
export const phaseKeys = (['static', 'critical', 'sliding'] as const).map((title) => ({
  title,
  color: phaseColors[title],
}));

/// Fills the legend of phases.
export function fillLegend(parent: HTMLElement): void {
  for (const [phase, meaning] of Object.entries(meanings) as [keyof typeof meanings, string][]) {
    const entry = create('span', { className: 'phase', textContent: phase, title: meaning });
    entry.style.setProperty('--phase', phaseColors[phase]);
    entry.classList.toggle('critical', phase === 'critical');
    parent.append(entry);
  }
}

/// Adds what is tracked to the legend: in a replay, and at an operator's site.
export function addTrackedLegend(parent: HTMLElement, text: string): void {
  const entry = create('span', { className: 'phase', textContent: text });
  entry.style.setProperty('--phase', sourceColors.tracked);
  parent.append(entry);
}

/// The lowest and the highest cell's height [m], with the colours between them.
export function fillHeightLegend([low, high]: readonly [number, number]): void {
  const legend = byId('height-legend', HTMLParagraphElement);
  const stops = [0, 0.25, 0.5, 0.75, 1].map((share) => heightColor(share).getStyle());
  const bar = legend.querySelector<HTMLElement>('.bar')!;
  bar.style.background = `linear-gradient(to right, ${stops.join(', ')})`;
  const ends = legend.querySelectorAll<HTMLElement>('.ends > span');
  [low, high].forEach((height, i) => (ends[i].textContent = `${height.toFixed(2)} m`));
}
