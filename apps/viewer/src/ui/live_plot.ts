// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { componentColors, phaseColors, sourceColors, toolColors } from '../palette';
import type { LiveState, Phase, Vector } from '../protocol';
import type { SceneModel } from '../scene/scene_model';
import { measuredTime } from '../session/measured';
import { length } from './format';
import { phaseKeys } from './legend';
import { TimePlot } from './plot';
import { steadyTop } from './plot_axes';
import type { CsvTable } from './plot_files';
import type { PlotBand, PlotLimit, PlotSeries } from './plot_options';
import { rangeWithoutSpikes } from './plot_spikes';

const shownSeconds = 10;
const redrawSeconds = 1 / 12; // smooth enough for a curve
const maxSamples = 2000;
const minSpan = 2; // [N]

interface Sample {
  time: number; // [s] of the world
  clock: number; // [s] since 1970, when the state came
  force: Vector; // [N] on the hand
  object: string; // that the tool touched last
  phase: Phase; // of it
}

/// Plots the force over the last seconds, with the phases of the object that the tool touched last,
/// and the force at which it breaks away.
export class LivePlot {
  private readonly plot: TimePlot;
  private samples: Sample[] = [];
  private drawn: Sample[] = [];
  private measured: { time: number; force: number }[] = []; // at the robot, at an operator's site
  private drawnMeasured: number[] = []; // [N] at the drawn samples
  private touched = -1; // index of the object that the tool touched last
  private lastDrawn = -Infinity;
  private top = minSpan; // [N]

  constructor(
    parent: HTMLElement,
    private readonly model: SceneModel,
    private readonly hasRobot: boolean,
  ) {
    this.plot = new TimePlot(parent, {
      title: 'Force on the hand',
      lanes: ['phase'],
      bandKeys: phaseKeys,
      unit: 'N',
      series: this.series(),
      minSpan,
      table: () => this.table(),
    });
    this.clear();
  }

  private series(): PlotSeries[] {
    const measured = { title: 'measured at the robot', color: sourceColors.measured };
    return [
      { title: 'on the hand', color: toolColors.force },
      ...(this.hasRobot ? [measured] : []),
      ...Object.entries(componentColors).map(([title, color]) => ({
        title,
        color,
        isComponent: true,
      })),
    ];
  }

  /// Adds a state; `names`: of its objects; `now` [s] only limits the redraw rate.
  add(state: LiveState, names: readonly string[], now: number): void {
    const last = this.samples[this.samples.length - 1]?.time ?? -Infinity;
    if (state.worldTime < last) this.samples = this.measured = [];
    if (state.worldTime === last) return;
    if (state.touchedObject >= 0) this.touched = state.touchedObject;
    this.samples.push({
      time: state.worldTime,
      clock: Date.now() / 1000,
      force: state.force,
      object: names[this.touched] ?? '',
      phase: state.objects[this.touched]?.phase ?? 'free',
    });
    const from = state.worldTime - shownSeconds;
    this.addMeasured(state, from);
    if (this.samples.length > maxSamples || this.samples[0].time < from - 1)
      this.samples = this.samples.slice(-maxSamples).filter(({ time }) => time >= from);
    // A part that the user looks at stands still.
    if (TimePlot.isZoomed || now - this.lastDrawn < redrawSeconds) return;
    this.lastDrawn = now;
    this.draw(state.worldTime, names[this.touched]);
  }

  /// Without a server nothing is known.
  clear(): void {
    this.samples = [];
    this.measured = [];
    this.plot.setFrame({ bands: [], limits: [], minSpan });
    this.drawn = [];
    this.drawnMeasured = [];
    const empty = this.series().map(() => [NaN, NaN]);
    this.plot.setData([-shownSeconds, 0], empty, -shownSeconds, 0);
  }

  private draw(now: number, object: string | undefined): void {
    this.drawn = [...this.samples];
    this.drawnMeasured = this.measuredAtSamples();
    const limits = this.limits(object);
    const columns = this.columns();
    const [, high] = rangeWithoutSpikes(columns);
    this.top = steadyTop(Math.max(high, ...limits.map(({ value }) => value)), this.top, minSpan);
    const title = object ? `Force on the hand, from ${object}` : 'Force on the hand';
    this.plot.setFrame({ title, bands: phaseRuns(this.drawn, now), limits, minSpan: this.top });
    const ago = this.drawn.map(({ time }) => time - now);
    this.plot.setData(ago, columns, -shownSeconds, 0);
  }

  /// In the order of the series.
  private columns(): number[][] {
    return [
      this.drawn.map(({ force }) => length(force)),
      ...(this.hasRobot ? [this.drawnMeasured] : []),
      ...[0, 1, 2].map((axis) => this.drawn.map(({ force }) => force[axis])),
    ];
  }

  private table(): CsvTable {
    const { drawn } = this;
    const columns = this.columns();
    return [
      { name: 'time of the world (s)', values: drawn.map(({ time }) => time) },
      { name: 'time since 1970 (s)', values: drawn.map(({ clock }) => clock) },
      { name: 'object', values: drawn.map(({ object }) => object) },
      { name: 'phase', values: drawn.map(({ phase }) => phase) },
      ...this.series().map(({ title }, i) => ({ name: `${title} (N)`, values: columns[i] })),
    ];
  }

  /// The robot's force arrives later, and belongs to an earlier time of the world.
  private addMeasured(state: LiveState, from: number): void {
    if (!state.link?.robot) return;
    const time = measuredTime(state, state.link);
    const isNewer = time > (this.measured.at(-1)?.time ?? -Infinity);
    if (isNewer) this.measured.push({ time, force: length(state.link.robot.force) });
    while (this.measured.length > 0 && this.measured[0].time < from) this.measured.shift();
  }

  /// Interpolated at the samples' times; NaN before the first and after the newest.
  private measuredAtSamples(): number[] {
    let next = 0;
    return this.drawn.map(({ time }) => {
      while (next < this.measured.length && this.measured[next].time < time) ++next;
      const [a, b] = [this.measured[next - 1], this.measured[next]];
      if (!a || !b) return NaN;
      return a.force + ((time - a.time) / (b.time - a.time)) * (b.force - a.force);
    });
  }

  private limits(name: string | undefined): PlotLimit[] {
    const object = this.model.objects.find((other) => other.name === name);
    const value = object?.parameters?.limiting_static_friction;
    return value === undefined ? [] : [{ value, title: `${name} breaks away` }];
  }
}

/// A band for each run of equal phases, except free; times from `now`.
export function phaseRuns(
  samples: readonly { time: number; phase: Phase }[],
  now: number,
): PlotBand[] {
  const bands: PlotBand[] = [];
  let start = 0;
  for (let i = 1; i <= samples.length; ++i) {
    const { phase, time } = samples[start];
    if (i < samples.length && samples[i].phase === phase) continue;
    const to = samples[Math.min(i, samples.length - 1)].time - now;
    if (phase !== 'free') bands.push({ from: time - now, to, lane: 0, color: phaseColors[phase] });
    start = i;
  }
  return bands;
}
