// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A spike is a value far above nearly all others. It does not count for an axis' range, where it
// would flatten the rest of its curve, and is marked at the edge with its value instead.

const commonShare = 0.95; // of the values of a curve that are not about zero
const spikeRatio = 3; // of a spike to what the common values stay below
const aboutZero = 0.05; // of the largest value: the time without contact says nothing of a contact
const minCount = 20; // of fewer values none is rare

type Column = ArrayLike<number>;

/// The magnitude above which a value is a spike; Infinity where there are too few to say.
function spikeLimit(sizes: readonly number[]): number {
  const sorted = Float64Array.from(sizes).filter(Number.isFinite).sort();
  const largest = sorted[sorted.length - 1] ?? 0;
  const counted = sorted.filter((size) => size > aboutZero * largest);
  if (counted.length < minCount) return Infinity;
  return spikeRatio * counted[Math.floor(commonShare * (counted.length - 1))];
}

/// The least and the greatest value of all curves without their spikes, and zero. A curve that is
/// nearly always about zero is judged by all curves together.
export function rangeWithoutSpikes(curves: readonly Column[]): [number, number] {
  const sizes = curves.map((curve) => Array.from(curve, Math.abs));
  const commonLimit = spikeLimit(sizes.flat());
  let [low, high] = [0, 0];
  curves.forEach((curve, k) => {
    const own = spikeLimit(sizes[k]);
    const limit = own < Infinity ? own : commonLimit;
    for (let i = 0; i < curve.length; ++i) {
      if (!(sizes[k][i] <= limit)) continue;
      low = Math.min(low, curve[i]);
      high = Math.max(high, curve[i]);
    }
  });
  return [low, high];
}

export interface Spike {
  time: number; // [s]
  value: number;
}

/// The values outside of a range; of those less than `gap` [s] apart only the largest.
export function spikesOutside(
  times: readonly number[],
  values: Column,
  [low, high]: readonly [number, number],
  gap: number,
): Spike[] {
  const spikes: Spike[] = [];
  let previous = -Infinity; // [s] time of the last value outside
  for (let i = 0; i < times.length; ++i) {
    const [time, value] = [times[i], values[i]];
    if (!(value < low || value > high)) continue;
    const last = spikes.at(-1);
    if (!last || time - previous > gap || last.value > high !== value > high)
      spikes.push({ time, value });
    else if (Math.abs(value) > Math.abs(last.value)) spikes[spikes.length - 1] = { time, value };
    previous = time;
  }
  return spikes;
}
