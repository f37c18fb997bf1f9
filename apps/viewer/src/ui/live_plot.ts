// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { phaseColors, toolColors } from '../palette';
import type { LiveState, Phase } from '../protocol';
import type { SceneModel } from '../scene/scene_model';
import { length } from './format';
import { phaseKeys } from './legend';
import { type PlotBand, type PlotLimit, TimePlot } from './plot';
import { steadyTop } from './plot_axes';

const shownSeconds = 10;
const redrawSeconds = 1 / 12; // smooth enough for a curve
const maxSamples = 2000;
const minSpan = 2; // [N]

interface Sample {
  time: number; // [s] of the world
  force: number; // [N]
  phase: Phase; // of the object pushed
}

/// Plots the force over the last seconds, with the phases of the object pushed, and the force at
/// which it breaks away.
export class LivePlot {
  private readonly plot: TimePlot;
  private samples: Sample[] = [];
  private pushed = -1; // index of the object that the tool touched last
  private lastDrawn = -Infinity;
  private top = minSpan; // [N]

  constructor(
    parent: HTMLElement,
    private readonly model: SceneModel,
  ) {
    this.plot = new TimePlot(parent, {
      title: 'Force on the hand',
      note: 'band: phase of the object pushed',
      bandKeys: phaseKeys,
      unit: 'N',
      series: [{ title: 'magnitude', color: toolColors.force }],
      height: 110,
      minSpan,
    });
    this.clear();
  }

  /// Adds a state; `names`: of its objects; `now` [s] only limits the redraw rate.
  add(state: LiveState, names: readonly string[], now: number): void {
    const last = this.samples[this.samples.length - 1]?.time ?? -Infinity;
    if (state.worldTime < last) this.samples = [];
    if (state.worldTime === last) return;
    if (state.touchedObject >= 0) this.pushed = state.touchedObject;
    this.samples.push({
      time: state.worldTime,
      force: length(state.force),
      phase: state.objects[this.pushed]?.phase ?? 'free',
    });
    const from = state.worldTime - shownSeconds;
    if (this.samples.length > maxSamples || this.samples[0].time < from - 1)
      this.samples = this.samples.slice(-maxSamples).filter(({ time }) => time >= from);
    // A part that the user looks at stands still.
    if (this.plot.isZoomed || now - this.lastDrawn < redrawSeconds) return;
    this.lastDrawn = now;
    this.draw(state.worldTime, names[this.pushed]);
  }

  /// Without a server nothing is known.
  clear(): void {
    this.samples = [];
    this.plot.setFrame([], [], minSpan);
    this.plot.setData([-shownSeconds, 0], [[NaN, NaN]], -shownSeconds, 0);
  }

  private draw(now: number, name: string | undefined): void {
    const limits = this.limits(name);
    const forces = this.samples.map(({ force }) => force);
    const high = Math.max(0, ...forces, ...limits.map(({ value }) => value));
    this.top = steadyTop(high, this.top, minSpan);
    this.plot.setFrame(phaseRuns(this.samples, now), limits, this.top);
    const ago = this.samples.map(({ time }) => time - now);
    this.plot.setData(ago, [forces], -shownSeconds, 0);
  }

  private limits(name: string | undefined): PlotLimit[] {
    const object = this.model.objects.find((other) => other.name === name);
    const value = object?.parameters?.limiting_static_friction;
    return value === undefined ? [] : [{ value, title: `${name} breaks away` }];
  }
}

/// A band for each run of equal phases, except free; times from `now`.
export function phaseRuns(samples: readonly Sample[], now: number): PlotBand[] {
  const bands: PlotBand[] = [];
  let start = 0;
  for (let i = 1; i <= samples.length; ++i) {
    const { phase, time } = samples[start];
    if (i < samples.length && samples[i].phase === phase) continue;
    const to = samples[Math.min(i, samples.length - 1)].time - now;
    if (phase !== 'free') bands.push({ from: time - now, to, row: 0, color: phaseColors[phase] });
    start = i;
  }
  return bands;
}
