// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  componentColors,
  fixedColor,
  objectColors,
  phaseColors,
  sourceColors,
  toolColors,
} from '../src/palette';
import { bandOpacity, kindColors } from '../src/report/colors';
import { colorDifference, labOf, minDifferenceOf, tint } from './color_difference';

// Metric: CIEDE2000, its minimum over normal vision and simulated protanopia, deuteranopia and
// tritanopia. 15 is some seven times the just noticeable difference of adjacent patches, so that
// patches apart from each other are distinguished too.
const minDifference = 15;
const minBandDifference = 7; // of pale areas that touch each other
const backgrounds = { light: '#e9edf1', dark: '#15191e' }; // of the scene
const minToBackground = 15;

const phases = Object.values(phaseColors);
const sources = Object.values(sourceColors);

function assertDistinct(colors: readonly string[], others: readonly string[], least: number): void {
  for (const a of colors)
    for (const b of others)
      if (a !== b) {
        const found = minDifferenceOf(a, b);
        assert.ok(found >= least, `${a} and ${b} differ by ${found.toFixed(1)} only`);
      }
}

test('the colour difference is that of its published examples', () => {
  // Sharma, Wu and Dalal 2005, table 1: pairs 1, 7, 17 and 25.
  const examples: [[number, number, number], [number, number, number], number][] = [
    [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
    [[50, 0, 0], [50, -1, 2], 2.3669],
    [[50, 2.5, 0], [73, 25, -18], 27.1492],
    [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  ];
  for (const [a, b, expected] of examples) {
    assert.ok(Math.abs(colorDifference(a, b) - expected) < 1e-4, `${colorDifference(a, b)}`);
    assert.ok(Math.abs(colorDifference(b, a) - expected) < 1e-4);
  }
});

test('objects, phases and sources differ to every kind of colour vision', () => {
  const objects = [...objectColors, fixedColor];
  assertDistinct(objects, objects, minDifference);
  assertDistinct(phases, phases, minDifference);
  assertDistinct(sources, sources, minDifference);
});

test('no phase has the colour of an object or of a source', () => {
  assertDistinct(phases, [...objectColors, fixedColor, ...sources], minDifference);
  assert.equal(new Set([...phases, ...objectColors, fixedColor]).size, phases.length + 7);
});

test('objects, phases and sources are seen on both backgrounds', () => {
  for (const [theme, background] of Object.entries(backgrounds))
    for (const color of [...objectColors, ...phases, ...sources]) {
      const found = colorDifference(labOf(color), labOf(background));
      assert.ok(found >= minToBackground, `${color} on ${theme}: ${found.toFixed(1)}`);
    }
});

test('the components of a force differ from each other and from its magnitude', () => {
  const components = Object.values(componentColors);
  assertDistinct(components, components, minDifference);
  const { measured, predicted } = sourceColors;
  assertDistinct(components, [toolColors.force, measured, predicted], minDifference);
});

test('the bands of phases behind curves differ', () => {
  const bands = kindColors.slice(1).map((color) => tint(color, bandOpacity));
  assertDistinct(bands, bands, minBandDifference);
});

test("the tool's ball or its rim stands out on both backgrounds", () => {
  const { ball, rim, touch } = toolColors;
  const minContrast = 50; // the ball is a few pixels large
  for (const background of Object.values(backgrounds))
    for (const inside of [ball, touch]) {
      const found = Math.max(minDifferenceOf(inside, background), minDifferenceOf(rim, background));
      assert.ok(found >= minContrast, `${inside} on ${background}: ${found.toFixed(1)}`);
      assert.ok(minDifferenceOf(inside, rim) >= minContrast);
    }
});
