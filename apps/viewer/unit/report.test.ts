// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { placeLabels, type PlacedLabel } from '../src/report/mark_labels';
import { screen } from '../src/report/medium';
import { number } from '../src/report/number';
import { type PlotData, readReport, type Series, type TableData } from '../src/report/report_data';
import { numberColumns } from '../src/report/tables';
import { viewOfArea, viewOfColumns, wholeView } from '../src/report/view';

const square = 1; // aspect

function plotOf(x: Series['x'], y: Series['y'], more: Partial<PlotData> = {}): PlotData {
  return {
    title: '',
    x_label: '',
    y_label: '',
    series: [{ label: '', color: 0, x, y }],
    bands: [],
    band_labels: [],
    marks: [],
    pins: [],
    pin_label: '',
    hollow_pin_label: '',
    ...more,
  };
}

test('a plot shows all its values, with room above the maximum', () => {
  const view = wholeView(plotOf([1, null, 5], [-2, null, 8]), square);
  assert.deepEqual(view.x, [1, 5]);
  assert.deepEqual(view.y, [-2, 8.6]);
});

test('given limits of the axes are kept', () => {
  const limits = { x_from: 0, x_to: 4, y_to: 3, y_from_zero: true };
  const view = wholeView(plotOf([1, 5], [1, 8], limits), square);
  assert.deepEqual(view, { x: [0, 4], y: [0, 3] });
  assert.equal(wholeView(plotOf([1, 5], [1, 8], { from_zero: true }), square).x[0], 0);
});

test('a constant and a plot without values have axes too', () => {
  for (const plot of [plotOf([3], [7]), plotOf([], []), plotOf([null], [null])]) {
    const { x, y } = wholeView(plot, square);
    for (const [low, high] of [x, y]) assert.ok(high > low && Number.isFinite(high - low));
  }
});

test('a map has equal scales on both axes, and room around the path', () => {
  const plot = plotOf([0, 4], [0, 1], { equal_axes: true });
  for (const aspect of [0.5, 1, 2]) {
    const { x, y } = wholeView(plot, aspect);
    assert.ok(Math.abs((x[1] - x[0]) / (y[1] - y[0]) - aspect) < 1e-12);
    assert.ok(x[0] < 0 && x[1] > 4 && y[0] < 0 && y[1] > 1);
    assert.ok(Math.abs(x[0] + x[1] - 4) < 1e-12);
  }
  const part = viewOfArea({ x: [1, 2], y: [0, 0.1] }, 2);
  assert.deepEqual(part.x, [1, 2]);
  assert.ok(Math.abs(part.y[1] - part.y[0] - 0.5) < 1e-12);
});

test('a zoomed plot is scaled to the values in it', () => {
  const plot = plotOf([0, 1, 2, 3], [5, 1, 2, 9], { y_from_zero: true });
  const view = viewOfColumns(plot, [0.5, 2.5]);
  assert.deepEqual(view.x, [0.5, 2.5]);
  assert.deepEqual(view.y, [0, 2.12]);
});

test('columns of numbers and columns of text', () => {
  const table = (rows: string[][]): TableData => ({
    title: '',
    columns: rows[0],
    rows,
    note: '',
    folded: false,
  });
  assert.deepEqual(
    numberColumns(
      table([
        ['t1', 'box_1', '2.000', '-12', '1.2 ± 0.3', '-'],
        ['t2', 'box_1', 'missed', '-', 'not identified', '-'],
      ]),
    ),
    [false, false, true, true, true, false],
  );
  assert.deepEqual(numberColumns(table([['1', '9 N, and a remark that is long']])), [false, false]);
});

test('a number has six significant digits', () => {
  assert.equal(number(1234.56789), '1234.57');
  assert.equal(number(0.5), '0.5');
});

test('data of another format are refused', () => {
  assert.throws(
    () => readReport('{"format":"pcavr-report-data/9"}'),
    /is not pcavr-report-data\/1/,
  );
});

/// The labels' extents in SVG units, by row.
function extentsOf(labels: PlacedLabel[], perUnit: number): [number, number][][] {
  return Array.from({ length: screen.markRows }, (_, row) =>
    labels
      .filter((label) => label.row === row)
      .map(({ x, side, text }): [number, number] => {
        const from = x * perUnit - (side === 'left' ? 7 * text.length : 0);
        return [from, from + 7 * text.length];
      }),
  );
}

test('the labels of sixty time nodes do not overlap, and count those without room', () => {
  // Twelve pushes in a minute, five nodes each within 2 s, on 564 units.
  const marks = Array.from({ length: 60 }, (_, i) => ({
    x: 5 * Math.floor(i / 5) + [0, 0.1, 0.2, 1.6, 1.9][i % 5],
    label: `t${i + 1}`,
  }));
  const perUnit = 564 / 60;
  const labels = placeLabels(marks, perUnit, screen.markRows, 60);
  for (const row of extentsOf(labels, perUnit)) {
    row.forEach(([from], i) => assert.ok(i === 0 || row[i - 1][1] <= from, `${row[i - 1]}`));
  }
  const counted = labels.map(({ text }) => 1 + Number(text.split(' +')[1] ?? 0));
  assert.equal(
    counted.reduce((sum, count) => sum + count, 0),
    60,
  );
  assert.ok(labels.some(({ text }) => text.includes(' +')));
  // Zoomed in to one push, each has its own.
  const push = placeLabels(marks.slice(0, 5), 564 / 2, screen.markRows, 2);
  assert.deepEqual(
    push.map(({ text }) => text),
    ['t1', 't2', 't3', 't4', 't5'],
  );
});

test('marks that are far apart have their labels in the first row', () => {
  const labels = placeLabels(
    [0, 1, 2].map((x) => ({ x, label: `t${x}` })),
    100,
    screen.markRows,
    4,
  );
  assert.deepEqual(
    labels.map(({ row }) => row),
    [0, 0, 0],
  );
});

test('labels at the right edge are to the left of their lines', () => {
  const marks = [0.5, 0.93, 0.96].map((x) => ({ x, label: 'measured' }));
  const perUnit = 564;
  const labels = placeLabels(marks, perUnit, screen.markRows, 1);
  assert.deepEqual(
    labels.map(({ side, row }) => [side, row]),
    [
      ['right', 0],
      ['left', 0],
      ['left', 1],
    ],
  );
  for (const row of extentsOf(labels, perUnit)) {
    row.forEach(([from, to], i) => {
      assert.ok(from >= 0 && to <= perUnit, `${from} to ${to}`);
      assert.ok(i === 0 || row[i - 1][1] <= from, `${row[i - 1]}`);
    });
  }
});
