// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import * as Plot from '@observablehq/plot';
import { kindColors } from './colors';
import { hatchClass, makeHatch } from '../hatch';
import { draw } from './drawing';
import type { Medium } from './medium';
import { number } from './number';
import type { Interval, LaneData } from './report_data';
import type { Range } from './view';

// [SVG units]
const marginLeft = 190;
const marginBottom = 40;
const marginTop = 6;

interface Row extends Interval {
  row: string;
  name: string;
}

export function wholeSpan(chart: LaneData): Range {
  const intervals = chart.lanes.flatMap((lane) => lane.intervals);
  const from = intervals.reduce((least, { from: t }) => Math.min(least, t), Infinity);
  const to = intervals.reduce((most, { to: t }) => Math.max(most, t), -Infinity);
  return [from, Math.max(to, from + 1e-3)]; // a single instant has a width too
}

/// Draws the lanes below one another, with a gap between groups.
export function drawLanes(
  chart: LaneData,
  [from, to]: Range,
  { laneWidth, laneHeight }: Medium,
): Plot.Plot & SVGSVGElement {
  const keys: string[] = [];
  const heads: { row: string; group: string }[] = [];
  const rows: Row[] = [];
  chart.lanes.forEach(({ group, label, intervals }, i) => {
    const row = `${i} ${label}`;
    const isFirst = i === 0 || chart.lanes[i - 1].group !== group;
    if (isFirst && i > 0) keys.push(`${i} `);
    if (isFirst) heads.push({ row, group });
    keys.push(row);
    const shown = intervals.filter((one) => one.to >= from && one.from <= to);
    rows.push(...shown.map((one) => ({ ...one, row, name: `${group}, ${label}` })));
  });
  const critical = rows.filter(({ kind }) => hatchClass(kindColors[kind]) !== '');
  const hatch = makeHatch();
  const ends = {
    x1: (one: Row) => Math.max(one.from, from),
    x2: (one: Row) => Math.min(one.to, to),
    y: 'row',
  };
  return draw({
    width: laneWidth,
    height: marginTop + keys.length * laneHeight + marginBottom,
    marginTop,
    marginRight: 14,
    marginBottom,
    marginLeft,
    ariaLabel: chart.title,
    style: { fontSize: '12px' },
    x: { domain: [from, to] },
    y: { domain: keys, padding: 0.15 },
    marks: [
      Plot.gridX({ strokeOpacity: 0.15, ticks: 12 }),
      Plot.axisX({
        tickSize: 0,
        ticks: 12,
        label: chart.x_label,
        labelAnchor: 'center',
        labelArrow: 'none',
      }),
      Plot.axisY({ tickSize: 0, label: null, tickFormat: labelOf }),
      Plot.text(heads, {
        y: 'row',
        text: 'group',
        frameAnchor: 'left',
        textAnchor: 'start',
        dx: 8 - marginLeft,
        fontWeight: 600,
      }),
      Plot.barX(rows, {
        ...ends,
        fill: (one: Row) => kindColors[one.kind],
        insetRight: -0.6, // a phase of a single frame is visible
        title: (one: Row) =>
          `${one.name}: ${chart.kind_labels[one.kind]}\n${number(one.from)} to ${number(one.to)}`,
        tip: true,
      }),
      () => hatch.definition,
      Plot.barX(critical, { ...ends, fill: hatch.fill }),
    ],
  });
}

function labelOf(key: string): string {
  return key.slice(key.indexOf(' ') + 1);
}
