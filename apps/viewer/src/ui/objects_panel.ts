// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { phaseColors } from '../palette';
import type { Body } from '../scene/bodies';
import type { SceneObject } from '../scene/scene_model';
import type { Comparison } from '../session/measured';
import { byId, create, fillList, setPressed, setText } from './dom';
import { heading, newtons, significant, uncertain } from './format';

const minForceShown = 0.05; // [N]
const announceSeconds = 1; // min. interval between announcements: a push passes four phases in less

interface Row {
  button: HTMLButtonElement;
  phase: HTMLElement;
  number: HTMLElement;
}

export function phaseLabel(body: Body): string {
  if (!body.object.movable) return 'fixed';
  if (!body.isKnown) return '–';
  if (body.isOutsideModel) return 'outside the model';
  if (body.isBlocked) return 'blocked by the scan';
  return body.isSaturated ? 'max. force' : body.phase;
}

/// The square beside a phase.
export function setPhaseColor(element: HTMLElement, body: Body): void {
  element.style.setProperty('--phase', body.isKnown ? phaseColors[body.phase] : 'transparent');
  element.classList.toggle('critical', body.isKnown && body.phase === 'critical');
}

/// The objects with their phases, and the details of the selected one.
export class ObjectsPanel {
  selected: Body | null = null;
  private compared: Comparison | null = null; // of the selected one
  private readonly rows = new Map<Body, Row>();
  private readonly unannounced = new Set<Body>(); // phase changed since the last announcement
  private lastAnnounced = -Infinity; // [s]
  private readonly details = byId('details', HTMLElement);
  private readonly name = byId('details-name', HTMLHeadingElement);
  private readonly list = byId('details-list', HTMLElement);

  constructor(
    bodies: readonly Body[],
    private readonly announce: (text: string) => void,
  ) {
    const list = byId('objects', HTMLUListElement);
    for (const body of bodies) list.append(create('li', {}, this.addRow(body)));
    if (bodies.length === 0)
      list.append(create('li', { className: 'muted' }, 'none: nothing here can be pushed'));
  }

  select(body: Body | null): void {
    this.selected = body === this.selected ? null : body;
    for (const [other, row] of this.rows) setPressed(row.button, other === this.selected);
    this.details.hidden = this.selected === null;
    this.showDetails();
  }

  /// `force` [N] of the tool on each body; `comparison` of its prediction with its tracking.
  update(
    force: (body: Body) => number,
    comparison: (body: Body) => Comparison | null = () => null,
  ): void {
    this.compared = this.selected && comparison(this.selected);
    for (const [body, row] of this.rows) {
      const label = phaseLabel(body);
      if (row.phase.textContent !== label) {
        if (row.phase.textContent) this.unannounced.add(body);
        row.phase.textContent = label;
        setPhaseColor(row.phase, body);
      }
      const magnitude = force(body);
      setText(row.number, magnitude < minForceShown ? '' : newtons(magnitude));
    }
    this.announcePhases();
    this.showDetails();
  }

  private announcePhases(): void {
    const now = performance.now() / 1000;
    if (this.unannounced.size === 0 || now - this.lastAnnounced < announceSeconds) return;
    this.lastAnnounced = now;
    const phases = [...this.unannounced].map((body) => `${body.object.name}: ${phaseLabel(body)}`);
    this.announce(phases.join(', '));
    this.unannounced.clear();
  }

  private addRow(body: Body): HTMLButtonElement {
    const swatch = create('span', { className: 'swatch' });
    swatch.style.background = body.color;
    const row: Row = {
      phase: create('span', { className: 'phase' }),
      number: create('span', { className: 'number' }),
      button: create('button', { type: 'button' }),
    };
    row.button.append(
      swatch,
      create('span', { className: 'name', textContent: body.object.name }),
      row.phase,
      row.number,
    );
    row.button.setAttribute('aria-pressed', 'false');
    row.button.addEventListener('click', () => this.select(body));
    this.rows.set(body, row);
    return row.button;
  }

  private showDetails(): void {
    const body = this.selected;
    if (!body) return;
    setText(this.name, body.object.name);
    const { x, y, z } = body.solid.position;
    const rows: [string, string][] = [
      ['Phase', phaseLabel(body)],
      ['Position', [x, y, z].map((v) => (v * 1e3).toFixed(1)).join(', ') + ' mm'],
      ['Heading', heading(body.solid.quaternion.toArray())],
      ...comparisonRows(this.compared),
      ...parameterRows(body.object),
    ];
    const text = JSON.stringify(rows);
    if (this.list.dataset.shown === text) return;
    this.list.dataset.shown = text;
    fillList(this.list, rows);
  }
}

/// How far the prediction was off, by the newest tracked pose, and what the last correction changed.
export function comparisonRows(compared: Comparison | null): [string, string][] {
  if (!compared) return [];
  const mm = (length: number) => `${(1e3 * length).toFixed(1)} mm`;
  const rows: [string, string][] = [];
  if (Number.isFinite(compared.age)) rows.push(['Tracked', `${compared.age.toFixed(2)} s ago`]);
  if (Number.isFinite(compared.error)) rows.push(['Prediction was off by', mm(compared.error)]);
  if (Number.isFinite(compared.shift))
    rows.push(['Corrected by', `${mm(compared.shift)}, ${compared.shiftAge.toFixed(0)} s ago`]);
  return rows;
}

// Of the parameters from pcavr identify; n is the contact's exponent.
const units: Record<string, string> = {
  mass: 'kg',
  limiting_static_friction: 'N',
  viscous_friction: 'N s/m',
  loading_rate: 'N/s',
  contact_stiffness: 'N/mⁿ',
  contact_damping: 'N s/mⁿ⁺¹',
  friction_radius: 'm',
};

/// An object's mass, evidence and parameters, each value with its standard deviation if known.
export function parameterRows(object: SceneObject): [string, string][] {
  const values = object.parameters ?? {};
  const rows: [string, string][] = [];
  if (object.mass !== null && values.mass === undefined)
    rows.push(['Mass', `${significant(object.mass)} kg`]);
  if (object.evidence) rows.push(['Pose from', object.evidence.replaceAll('_', ' ')]);
  for (const [key, value] of Object.entries(values)) {
    if (key.endsWith('_std') || typeof value !== 'number') continue;
    const title = key.replaceAll('_', ' ');
    const text = `${uncertain(value, values[`${key}_std`])} ${units[key] ?? ''}`;
    rows.push([title[0].toUpperCase() + title.slice(1), text.trimEnd()]);
  }
  return rows;
}
