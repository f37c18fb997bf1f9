// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Sizes of drawings [SVG units]; their text is 12 units high.
export interface Medium {
  width: number;
  height: number; // of a chart
  mapHeight: number; // with its strip
  stripHeight: number;
  left: number; // of a chart: margin for the ticks and label of its y axis
  markRows: number; // of the labels of marks
  laneWidth: number;
  laneHeight: number;
}

/// A unit is about a pixel of a desktop screen.
export const screen: Medium = {
  width: 640,
  height: 300,
  mapHeight: 690, // two stacked charts with their headings
  stripHeight: 130,
  left: 62,
  markRows: 4,
  laneWidth: 1120,
  laneHeight: 22,
};

/// Three charts side by side on A4: a unit is about 0.2 mm, the text has 7 points.
export const paper: Medium = {
  width: 300,
  height: 168,
  mapHeight: 250,
  stripHeight: 86,
  left: 58,
  markRows: 2,
  laneWidth: 900,
  laneHeight: 17,
};

/// Draws anew for paper before the page is printed, and for the screen afterwards.
export function onPrint(draw: (medium: Medium) => void): void {
  addEventListener('beforeprint', () => draw(paper));
  addEventListener('afterprint', () => draw(screen));
}
