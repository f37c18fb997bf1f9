// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type uPlot from 'uplot';
import type { Phase } from '../protocol';
import { phaseColors } from '../scene/bodies';
import { cssColor, Plot } from '../ui/plot';
import { decimate } from './decimation';
import type { Replay, ReplayObject, Table } from './replay_data';

const buckets = 600; // about one per two screen columns: more would not be visible
const height = 150; // [CSS pixels]
const bandHeight = 5; // [CSS pixels] of each of the two phase bands

/// Error and force of one object over the whole replay, with phases and corrections.
export class ReplayPlots {
  private plots: Plot[] = [];

  constructor(
    private readonly parent: HTMLElement,
    private readonly replay: Replay,
    private readonly onSeek: (time: number) => void,
  ) {}

  show(object: ReplayObject): void {
    for (const plot of this.plots) plot.remove();
    const corrections = this.replay.model.corrections.filter((c) => c.object === object.name);
    const common = { height, onSeek: this.onSeek };
    const error = new Plot(this.parent, {
      ...common,
      title: 'Prediction error against tracking',
      note: corrections.length > 0 ? 'dashed: corrections' : '',
      unit: 'mm',
      rightUnit: '°',
      minSpan: 1,
      series: [
        { title: 'position', color: '#2b7de9' },
        { title: 'rotation', color: '#c2820a', scale: 'right' },
      ],
      drawBelow: (plot) =>
        drawMarks(
          plot,
          corrections.map(({ t }) => t),
        ),
    });
    const force = new Plot(this.parent, {
      ...common,
      title: 'Force',
      note: 'bands: measured, predicted phase',
      unit: 'N',
      minSpan: 2,
      series: [
        { title: 'measured', color: '#d6336c' },
        { title: 'predicted', color: '#2f9e6e' },
      ],
      drawBelow: (plot) => {
        drawPhases(plot, object, this.replay.model.duration);
        drawMarks(
          plot,
          corrections.map(({ t }) => t),
        );
      },
    });
    this.plots = [error, force];
    this.fill(error, object.error, [1e3, 180 / Math.PI]);
    this.fill(force, object.force, [1, 1]);
  }

  setPlayhead(time: number): void {
    for (const plot of this.plots) plot.setPlayhead(time);
  }

  redraw(): void {
    for (const plot of this.plots) plot.redraw();
  }

  private fill(plot: Plot, table: Table, scales: readonly number[]): void {
    const columns = scales.map((scale, i) => table.column(i + 1).map((v) => v * scale));
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

/// A dashed vertical line at each correction.
function drawMarks(plot: uPlot, times: readonly number[]): void {
  const { ctx: pen, bbox } = plot;
  pen.save();
  pen.strokeStyle = cssColor('--muted');
  pen.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
  pen.beginPath();
  for (const time of times) {
    const x = plot.valToPos(time, 'x', true);
    pen.moveTo(x, bbox.top);
    pen.lineTo(x, bbox.top + bbox.height);
  }
  pen.stroke();
  pen.restore();
}

/// The measured phase in a band along the top, the predicted one in a band below it.
function drawPhases(plot: uPlot, object: ReplayObject, duration: number): void {
  const { ctx: pen, bbox } = plot;
  const band = bandHeight * devicePixelRatio;
  pen.save();
  object.phases.forEach((phase, i) => {
    const from = plot.valToPos(phase.t, 'x', true);
    const to = plot.valToPos(object.phases[i + 1]?.t ?? duration, 'x', true);
    const draw = (kind: Phase, row: number) => {
      if (kind === 'free') return;
      pen.fillStyle = phaseColors[kind];
      pen.fillRect(from, bbox.top + row * (band + devicePixelRatio), to - from, band);
    };
    draw(phase.measured, 0);
    draw(phase.predicted, 1);
  });
  pen.restore();
}
