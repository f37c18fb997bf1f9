// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { phasesAt, type ReplayObject } from './replay_data';

/// The object that the tool touches at `time`, of several the one it pushes hardest; without any the
/// one it touched last, or else will touch first.
export function touchedAt(
  objects: readonly ReplayObject[],
  time: number,
): ReplayObject | undefined {
  let [best, bestRank] = [objects[0], -Infinity];
  for (const object of objects) {
    const rank = rankAt(object, time);
    if (rank > bestRank) [best, bestRank] = [object, rank];
  }
  return best;
}

/// In contact the force [N], at least 0; after it minus the time since [s]; before the first contact
/// still less, the less the later that is.
function rankAt(object: ReplayObject, time: number): number {
  const { force } = object;
  const now = force.at(time)?.[1] ?? NaN;
  // The first row of a contact may come a little after its phase.
  const isTouched = Number.isFinite(now) || phasesAt(object, time).measured !== 'free';
  if (isTouched) return Math.max(now || 0, 0);
  const row = force.rowAt(time);
  if (row >= 0) return force.time(row) - time;
  return force.rows > 0 ? beyond + time - force.time(0) : -Infinity;
}

const beyond = -1e9; // [s] longer than any recording
