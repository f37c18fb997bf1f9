// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { phaseColors } from './palette';
import { shape } from './ui/svg';

// "critical" is as bright as "static": in black and white they differ by its hatch.

const pitch = 4; // [CSS pixels]
const ink = '#10151b';
let drawings = 0;

/// The class of swatches with this colour: style sheets hatch "critical".
export function hatchClass(color: string): string {
  return color === phaseColors.critical ? 'critical' : '';
}

/// A definition for a drawing, and the fill that refers to it: lines, to be drawn over the colour.
export function makeHatch(): { definition: SVGElement; fill: string } {
  const id = `hatch-${++drawings}`;
  const box = { width: pitch, height: pitch };
  const line = shape('path', { d: `M0,0V${pitch}`, stroke: ink, 'stroke-width': 1.6 });
  const lines = shape(
    'pattern',
    { id, ...box, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)' },
    line,
  );
  return { definition: shape('defs', {}, lines), fill: `url(#${id})` };
}
