// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The colours of objects, phases and sources of poses and forces. C++ has the same in
// pcavr/perception/scene/palette.hpp; tests compare both, and the colours for every kind of colour vision.
import type { Phase } from './protocol';
import palette from './palette.json';

export const objectColors: readonly string[] = palette.objects;
export const fixedColor = palette.fixed;
export const phaseColors: Record<Phase, string> = palette.phases;
export const sourceColors = palette.sources;

/// The tool's ball with its rim, one of which is seen on any background; the ball in contact; force.
export const toolColors = { ball: '#f5f7fa', rim: '#10151b', touch: '#ffb300', force: '#d6336c' };

/// The components of a force along the axes of base, beside its magnitude.
export const componentColors = { x: '#902400', y: '#a6e65a', z: '#2448fc' };

/// The errors of a predicted pose.
export const errorColors = { position: '#3b82c4', rotation: '#c2820a' };

/// What a replay's time line marks.
export const eventColors = {
  contact: toolColors.touch,
  breakaway: phaseColors.sliding,
  correction: sourceColors.tracked,
};
