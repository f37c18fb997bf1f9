// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

export interface Mark {
  x: number;
  label: string;
}

export interface PlacedLabel {
  x: number;
  row: number;
  side: 'right' | 'left'; // of its line
  text: string;
}

// [SVG units] at a font of 12 px.
export const labelHeight = 14;
const characterWidth = 7;
const gap = 12; // between labels, and from a line to its label
const countLength = 3; // [characters] of a count that may follow a label

/// Places the labels of marks, in ascending order, so that none overlap: each in the highest row
/// that has room, to the left of its line where the plot ends too soon (at `end` of the x axis). A
/// mark without room adds to the count of the label before it: "t4 +2" are three marks, which
/// zooming in separates. `perUnit`: SVG units per unit of the x axis.
export function placeLabels(
  marks: Mark[],
  perUnit: number,
  rows: number,
  end: number,
): PlacedLabel[] {
  const placed: PlacedLabel[] = [];
  const ends = new Array<number>(rows).fill(-Infinity);
  const widthOf = (text: string) => characterWidth * text.length + gap;
  let hidden = 0;
  for (const { x, label } of marks) {
    const at = x * perUnit;
    const room = widthOf(label) + countLength * characterWidth;
    const side = at + room > end * perUnit ? 'left' : 'right';
    const from = side === 'left' ? at - room : at;
    const row = ends.findIndex((taken) => taken <= from);
    if (row >= 0) {
      placed.push({ x, row, side, text: label });
      ends[row] = side === 'left' ? at : at + widthOf(label);
      hidden = 0;
      continue;
    }
    const last = placed[placed.length - 1];
    hidden += 1;
    last.text = `${last.text.split(' +')[0]} +${hidden}`;
    if (last.side === 'right') ends[last.row] = last.x * perUnit + widthOf(last.text);
  }
  return placed;
}
