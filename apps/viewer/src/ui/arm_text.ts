// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { ArmState } from '../protocol';
import type { ArmModel } from '../scene/arm';

/// One line: how far the arm is from a collision, or what it was stopped before.
export function armText(state: ArmState, arm: ArmModel, objects: readonly string[]): string {
  const { nearest, isStopped } = state;
  if (!nearest) return '';
  const link = arm.links[nearest.link]?.name ?? 'a link';
  const other =
    nearest.otherLink !== null
      ? (arm.links[nearest.otherLink]?.name ?? 'another link')
      : nearest.object !== null
        ? (objects[nearest.object] ?? 'a guard')
        : 'the scan';
  const distance = `${(1000 * nearest.distance).toFixed(0)} mm`;
  return isStopped
    ? `arm stopped: ${link} would hit ${other} (${distance})`
    : `arm: ${link} is ${distance} from ${other}`;
}
