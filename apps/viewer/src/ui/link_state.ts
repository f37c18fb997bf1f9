// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector } from '../protocol';
import { layerNames, type LayerName } from '../scene/layers';

/// What a link to the page restores.
export interface LinkState {
  eye?: Vector; // [m] in base
  target?: Vector; // [m] in base, the point that the view turns about
  layers?: LayerName[]; // those shown
  time?: number; // [s] of a replay
}

const decimals = 3; // millimetres and milliseconds
const maxCoordinate = 1000; // [m]

/// The part of an address after its '#': `view=ex,ey,ez,tx,ty,tz&layers=mesh,bodies&t=1.5`.
export function encodeLink({ eye, target, layers, time }: LinkState): string {
  const parts: string[] = [];
  if (eye && target) parts.push(`view=${[...eye, ...target].map(rounded).join(',')}`);
  if (layers) parts.push(`layers=${layers.join(',')}`);
  if (time !== undefined) parts.push(`t=${rounded(time)}`);
  return parts.join('&');
}

/// The parts that are valid: an address may have been typed or cut.
export function decodeLink(hash: string): LinkState {
  const fields = new URLSearchParams(hash.replace(/^#/, ''));
  const state: LinkState = {};
  const view = (fields.get('view') ?? '').split(',').map(Number);
  if (view.length === 6 && view.every((x) => Math.abs(x) <= maxCoordinate)) {
    const [ex, ey, ez, tx, ty, tz] = view as [number, number, number, number, number, number];
    const isApart = Math.hypot(ex - tx, ey - ty, ez - tz) > 0.001;
    if (isApart) Object.assign(state, { eye: [ex, ey, ez], target: [tx, ty, tz] });
  }
  const layers = fields.get('layers');
  if (layers !== null) {
    const names = layers.split(',');
    state.layers = layerNames.filter((name) => names.includes(name));
  }
  const time = Number(fields.get('t') || NaN);
  if (Number.isFinite(time) && time >= 0) state.time = time;
  return state;
}

function rounded(value: number): string {
  return String(Number(value.toFixed(decimals)));
}
