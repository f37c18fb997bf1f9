// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

import { phaseColors, sourceColors, tint } from '../palette';

// Not in the style sheet: a saved plot has them too. The C++ side's indices: 0 what was predicted
// or rendered, 1 what was measured or is known, 2 what was tracked.
export const seriesColors = [
  sourceColors.predicted,
  sourceColors.measured,
  sourceColors.tracked,
  '#aa4499',
];
const phases = [phaseColors.free, phaseColors.static, phaseColors.critical, phaseColors.sliding];
const bandShare = 0.25; // of a phase's colour behind curves
export const bandColors = phases.map((color) => tint(color, bandShare));
export const laneColors = phases;
export const pinColor = seriesColors[3];
export const softInk = '#5b6570';
