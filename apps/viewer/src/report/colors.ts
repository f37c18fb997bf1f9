// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

import { phaseColors, sourceColors } from '../palette';

// Not in the style sheet: a saved plot has them too. The C++ side's indices: 0 what was predicted
// or rendered, 1 what was measured or is known, 2 what was tracked.
export const seriesColors = [
  sourceColors.predicted,
  sourceColors.measured,
  sourceColors.tracked,
  '#aa4499',
];
/// By kind, of lanes and of the bands behind curves.
export const kindColors = [
  phaseColors.free,
  phaseColors.static,
  phaseColors.critical,
  phaseColors.sliding,
];
export const bandOpacity = 0.25;
export const pinColor = seriesColors[3];
export const softInk = '#5b6570';
