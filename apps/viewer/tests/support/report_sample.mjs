// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A report with every kind of content, put into the built template as the C++ library does.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const template = new URL('../../dist-report/report.html', import.meta.url);
const rows = 4000; // of a decimated series

const seconds = Array.from({ length: rows }, (_, i) => (30 * i) / rows);
const series = (label, color, value, more = {}) => ({
  label,
  color,
  x: seconds,
  y: seconds.map(value),
  ...more,
});
const bands = [2, 8, 14, 20].flatMap((t) => [
  { from: t, to: t + 0.6, kind: 1 },
  { from: t + 0.6, to: t + 0.8, kind: 2 },
  { from: t + 0.8, to: t === 20 ? 1e12 : t + 2.5, kind: 3 },
]);
const bandLabels = ['', 'static', 'critical', 'sliding'];

const plot = (more) => ({
  title: 'A plot',
  x_label: 'time (s)',
  y_label: 'force (N)',
  series: [],
  bands: [],
  band_labels: [],
  marks: [],
  pins: [],
  pin_label: 'correction arrives',
  hollow_pin_label: 'correction lost',
  ...more,
});

const phased = plot({
  title: 'box_1: force of the tool',
  y_from_zero: true,
  series: [
    series('measured', 1, (t) => (t % 7 < 0.02 ? null : 9 * Math.sin(t) ** 2)),
    series('rendered (virtual)', 0, (t) => 9.5 * Math.sin(t) ** 2, { dashed: true }),
  ],
  bands,
  band_labels: bandLabels,
  marks: [2, 2.3, 2.6, 8, 14].map((x, i) => ({ x, label: `t${i + 1}` })),
  pins: [4, 9, 15].map((x, i) => ({ x, hollow: i === 1 })),
});

const map = plot({
  title: 'box_1, predicted: path from above',
  x_label: 'x in base (m)',
  y_label: 'y in base (m)',
  equal_axes: true,
  series: [
    {
      label: 'reference',
      color: 1,
      x: seconds.map((t) => 0.2 * Math.cos(t / 5)),
      y: seconds.map((t) => 0.2 * Math.sin(t / 5)),
    },
    { label: 'measured', color: 0, points: true, x: [0, 0.1, 0.2], y: [0.1, 0.05, 0.02] },
  ],
  strip: { label: 'position error (mm)', color: 0, x: [0, 0.1, 0.3], y: [0.2, 0.5, 0.1] },
  strip_x_label: 'length of the path (m)',
});

const histogram = plot({
  title: 'Distance, cumulative',
  x_label: 'distance (mm)',
  y_label: 'share (%)',
  from_zero: true,
  x_to: 15,
  y_to: 100,
  series: [{ label: 'accuracy', color: 0, x: [0.1, 3, 15], y: [0, 80, 100] }],
  marks: [{ x: 5, label: '5 mm' }],
});

const lanes = {
  kind: 'lanes',
  title: 'Phases over time',
  x_label: 'time (s)',
  kind_labels: ['free', 'static', 'critical', 'sliding'],
  lanes: ['box_1', 'box_2'].flatMap((group) =>
    ['truth', 'measured', 'predicted'].map((label, i) => ({
      group,
      label,
      intervals: [0, 5, 10, 15].flatMap((t) => [
        { from: t, to: t + 2 + 0.1 * i, kind: 0 },
        { from: t + 2 + 0.1 * i, to: t + 3, kind: 1 },
        { from: t + 3, to: t + 3.1, kind: 2 },
        { from: t + 3.1, to: t + 5, kind: 3 },
      ]),
    })),
  ),
};

const table = (more) => ({ title: '', columns: [], rows: [], note: '', folded: false, ...more });

export const sample = {
  format: 'pcavr-report-data/1',
  title: 'Run evaluation: <run>',
  heading: 'Run evaluation',
  inputs: [
    [
      { text: 'run ', strong: false },
      { text: '<b>my & run</b>', strong: true },
    ],
    [{ text: 'compared with the truth', strong: false }],
  ],
  verdict: 'Objects were tracked to 0.17 mm (rmse).',
  notes: ['box_3 has no pose in this run.'],
  headline: table({
    columns: ['metric', 'value', 'unit'],
    rows: Array.from({ length: 16 }, (_, i) => [`Predicted position error ${i}`, `${i}.25`, 'mm']),
  }),
  sections: [
    {
      title: 'Overview',
      blocks: [
        { kind: 'text', text: 'Phases are those of the truth.', highlighted: false },
        lanes,
        {
          kind: 'tables',
          tables: [
            table({
              title: 'Time nodes',
              columns: ['node', 'object', 'event', 'truth (s)', 'error (ms)'],
              rows: [
                ['t1', 'box_1', 'contact', '2.000', '-'],
                ['t2', 'box_1', 'critical', 'missed', '-12'],
              ],
              note: 'Missed: no event of that kind within 0.5 s.',
            }),
            table({
              title: 'Each correction',
              columns: ['object', 'bytes'],
              rows: [['box_1', '120']],
              folded: true,
            }),
          ],
        },
      ],
    },
    {
      title: 'box_1',
      blocks: [
        { kind: 'text', text: 'The tool jumps.', highlighted: true },
        { kind: 'plots', title: 'Plots', plots: [phased, map, histogram] },
      ],
    },
  ],
  footer: 'pcavr',
  command: "pcavr evaluate 'my & run'",
};

/// Writes a report into a temporary folder; `url` opens it.
export function writeReport(data) {
  const folder = mkdtempSync(join(tmpdir(), 'pcavr-report-'));
  const file = join(folder, 'report.html');
  const text = JSON.stringify(data).replaceAll('<', '\\u003c');
  const page = readFileSync(template, 'utf8');
  writeFileSync(
    file,
    page.replace('REPORT_DATA', () => text),
  );
  return { url: `file://${file}`, remove: () => rmSync(folder, { recursive: true }) };
}
