// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Phase } from '../protocol';
import { componentColors, errorColors, phaseColors, sourceColors } from '../palette';
import { phaseKeys } from '../ui/legend';
import { TimePlot } from '../ui/plot';
import type { CsvTable } from '../ui/plot_files';
import type { PlotBand, PlotSeries } from '../ui/plot_options';
import { decimate } from './decimation';
import { phasesAt, type Replay, type ReplayObject, type Table } from './replay_data';

const buckets = 600; // about one per two screen columns: more would not be visible
const degrees = 180 / Math.PI;
const millimetres = 1e3;

const errorSeries: PlotSeries[] = [
  { title: 'position', color: errorColors.position },
  { title: 'rotation', color: errorColors.rotation, isRight: true },
];
const forceSeries: PlotSeries[] = [
  { title: 'measured', color: sourceColors.measured },
  { title: 'predicted', color: sourceColors.predicted },
  ...Object.entries(componentColors).map(([axis, color]) => ({
    title: `${axis} as recorded`,
    color,
    isComponent: true,
  })),
];

/// Error and force of one object over the whole replay, with phases and corrections.
export class ReplayPlots {
  private readonly error: TimePlot;
  private readonly force: TimePlot;
  private shown: ReplayObject | undefined;

  constructor(
    parent: HTMLElement,
    private readonly replay: Replay,
    onSeek: (time: number) => void,
  ) {
    const hasCorrections = replay.model.corrections.length > 0;
    this.error = new TimePlot(parent, {
      title: 'Prediction error',
      note: hasCorrections ? 'dashed: corrections' : '',
      unit: 'mm',
      rightUnit: '°',
      minSpan: 1,
      series: errorSeries,
      onSeek,
      table: () => this.errorTable(),
    });
    this.force = new TimePlot(parent, {
      title: 'Force',
      lanes: ['measured', 'predicted'],
      bandKeys: phaseKeys,
      unit: 'N',
      minSpan: 2,
      series: forceSeries,
      onSeek,
      table: () => this.forceTable(),
    });
  }

  show(object: ReplayObject): void {
    if (object === this.shown) return;
    this.shown = object;
    const { corrections, duration } = this.replay.model;
    const marks = corrections.filter((c) => c.object === object.name).map(({ t }) => t);
    const { name } = object;
    this.error.setFrame({ title: `Prediction error of ${name}`, marks });
    this.force.setFrame({
      title: `Force on ${name}`,
      marks,
      bands: phaseBands(object, duration),
    });
    this.fill(this.error, object.error, this.errorColumns(object));
    this.fill(this.force, object.force, this.forceColumns(object));
  }

  setPlayhead(time: number): void {
    for (const plot of [this.error, this.force]) plot.setPlayhead(time);
  }

  private errorColumns({ error }: ReplayObject): Float64Array[] {
    return [millimetres, degrees].map((scale, i) =>
      error.column(i + 1).map((value) => value * scale),
    );
  }

  /// Measured and predicted along the push, and the components of the recorded force.
  private forceColumns({ force }: ReplayObject): Float64Array[] {
    const [times, measured, predicted] = [0, 1, 2].map((column) => force.column(column));
    const recorded = Array.from(times, (time, row) =>
      Number.isNaN(measured[row]) ? null : this.replay.tool.at(time),
    );
    const components = [4, 5, 6].map((column) =>
      Float64Array.from(recorded, (values) => values?.[column] ?? NaN),
    );
    return [measured, predicted, ...components];
  }

  private errorTable(): CsvTable {
    const object = this.shown;
    if (!object) return [];
    const columns = this.errorColumns(object);
    return [
      ...this.commonColumns(object, object.error),
      { name: 'position (mm)', values: rounded(columns[0]) },
      { name: 'rotation (°)', values: rounded(columns[1]) },
    ];
  }

  private forceTable(): CsvTable {
    const object = this.shown;
    if (!object) return [];
    const columns = this.forceColumns(object);
    return [
      ...this.commonColumns(object, object.force),
      ...forceSeries.map(({ title }, i) => ({
        name: `${title} (N)`,
        values: rounded(columns[i]),
      })),
    ];
  }

  /// Times, object and phases of each row.
  private commonColumns(object: ReplayObject, table: Table): CsvTable {
    const times = [...table.column(0)];
    const phases = times.map((time) => phasesAt(object, time));
    const { start } = this.replay.model;
    return [
      { name: 'time (s)', values: times.map(microseconds) },
      {
        name: "time on the recording's clock (s)",
        values: times.map((t) => microseconds(start + t)),
      },
      { name: 'object', values: times.map(() => object.name) },
      { name: 'phase measured', values: phases.map(({ measured }) => measured) },
      { name: 'phase predicted', values: phases.map(({ predicted }) => predicted) },
    ];
  }

  private fill(plot: TimePlot, table: Table, columns: readonly Float64Array[]): void {
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

/// The digits that a number in single precision has.
function rounded(values: Float64Array): Float64Array {
  return values.map((value) => Number(value.toPrecision(7)));
}

function microseconds(seconds: number): number {
  return Number(seconds.toFixed(6));
}

/// The measured phases in the first lane, the predicted ones below.
function phaseBands(object: ReplayObject, duration: number): PlotBand[] {
  return object.phases.flatMap((phase, i) => {
    const to = object.phases[i + 1]?.t ?? duration;
    const band = (kind: Phase, lane: number) =>
      kind === 'free' ? [] : [{ from: phase.t, to, lane, color: phaseColors[kind] }];
    return [...band(phase.measured, 0), ...band(phase.predicted, 1)];
  });
}
