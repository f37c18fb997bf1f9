// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Phase } from '../protocol';
import { phaseColors, sourceColors } from '../palette';
import { phaseKeys } from '../ui/legend';
import { type PlotBand, TimePlot } from '../ui/plot';
import { decimate } from './decimation';
import type { Replay, ReplayObject, Table } from './replay_data';

const buckets = 600; // about one per two screen columns: more would not be visible
const height = 150; // [CSS pixels]
const errorScales = [1e3, 180 / Math.PI]; // to mm and degrees
const forceScales = [1, 1];

/// Error and force of one object over the whole replay, with phases and corrections.
export class ReplayPlots {
  private plots: TimePlot[] = [];

  constructor(
    private readonly parent: HTMLElement,
    private readonly replay: Replay,
    private readonly onSeek: (time: number) => void,
  ) {}

  show(object: ReplayObject): void {
    for (const plot of this.plots) plot.remove();
    const corrections = this.replay.model.corrections.filter((c) => c.object === object.name);
    const marks = corrections.map(({ t }) => t);
    const common = { height, onSeek: this.onSeek, marks };
    const save = (table: Table, scales: readonly number[]) => () => ({
      times: [...table.column(0)],
      columns: scaled(table, scales),
    });
    const error = new TimePlot(this.parent, {
      ...common,
      save: save(object.error, errorScales),
      title: 'Prediction error against tracking',
      note: corrections.length > 0 ? 'dashed: corrections' : '',
      unit: 'mm',
      rightUnit: '°',
      minSpan: 1,
      series: [
        { title: 'position', color: '#3b82c4' },
        { title: 'rotation', color: '#c2820a', isRight: true },
      ],
    });
    const force = new TimePlot(this.parent, {
      ...common,
      save: save(object.force, forceScales),
      title: 'Force',
      note: 'bands: phase measured, below it predicted',
      bandKeys: phaseKeys,
      unit: 'N',
      minSpan: 2,
      series: [
        { title: 'measured', color: sourceColors.measured },
        { title: 'predicted', color: sourceColors.predicted },
      ],
      bands: phaseBands(object, this.replay.model.duration),
    });
    this.plots = [error, force];
    this.fill(error, object.error, errorScales);
    this.fill(force, object.force, forceScales);
  }

  setPlayhead(time: number): void {
    for (const plot of this.plots) plot.setPlayhead(time);
  }

  private fill(plot: TimePlot, table: Table, scales: readonly number[]): void {
    const columns = scaled(table, scales);
    const rows = decimate(columns, buckets);
    const times = table.column(0);
    plot.setData(
      rows.map((row) => times[row]),
      columns.map((column) => rows.map((row) => column[row])),
      0,
      this.replay.model.duration,
    );
  }
}

function scaled(table: Table, scales: readonly number[]): Float64Array[] {
  return scales.map((scale, i) => table.column(i + 1).map((value) => value * scale));
}

/// The measured phases in the first row, the predicted ones below.
function phaseBands(object: ReplayObject, duration: number): PlotBand[] {
  return object.phases.flatMap((phase, i) => {
    const to = object.phases[i + 1]?.t ?? duration;
    const band = (kind: Phase, row: number) =>
      kind === 'free' ? [] : [{ from: phase.t, to, row, color: phaseColors[kind] }];
    return [...band(phase.measured, 0), ...band(phase.predicted, 1)];
  });
}
