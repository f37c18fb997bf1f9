// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Phase } from '../protocol';
import { phaseColors } from '../palette';
import { newtons } from './format';

/// What a video says of the world at one instant.
export interface Caption {
  time: number; // [s] of the replay or the world
  tracked: string; // what an outline means; empty without tracking
  objects: {
    name: string;
    phase: Phase;
    label: string; // of the phase
    force: number; // [N]
    error: number; // [m] of the prediction; NaN where it is not known
  }[];
}

const maxObjects = 6; // more would hide the scene
// [CSS pixels]
const line = 20;
const margin = 12;
const padding = 8;
const swatch = 12;

/// Time, and each object's phase, force and error, at the upper left. `scale`: pixels per CSS pixel.
export function drawCaption(pen: CanvasRenderingContext2D, caption: Caption, scale: number): void {
  const objects = caption.objects.slice(0, maxObjects);
  const rows = [
    { text: `${caption.time.toFixed(2)} s`, color: null },
    ...objects.map((object) => ({ text: textOf(object), color: phaseColors[object.phase] })),
    ...(caption.tracked === '' ? [] : [{ text: caption.tracked, color: null }]),
  ];
  pen.save();
  pen.scale(scale, scale);
  pen.font = '600 14px system-ui, sans-serif';
  const wide = Math.max(...rows.map(({ text }) => pen.measureText(text).width));
  pen.fillStyle = 'rgb(16 22 29 / 75%)';
  pen.fillRect(margin, margin, wide + 2 * padding + 2 * swatch, rows.length * line + 2 * padding);
  rows.forEach(({ text, color }, i) => {
    const y = margin + padding + (i + 0.5) * line;
    const x = margin + padding;
    if (color !== null) {
      pen.fillStyle = color;
      pen.fillRect(x, y - swatch / 2, swatch, swatch);
    }
    pen.fillStyle = '#ffffff';
    pen.textBaseline = 'middle';
    pen.fillText(text, color === null ? x : x + 1.6 * swatch, y);
  });
  pen.restore();
}

/// "r_box: sliding, 7.2 N, predicted 1.3 mm off".
function textOf({ name, label, force, error }: Caption['objects'][number]): string {
  const parts = [label, newtons(force)];
  if (Number.isFinite(error)) parts.push(`predicted ${(1000 * error).toFixed(1)} mm off`);
  return `${name}: ${parts.join(', ')}`;
}
