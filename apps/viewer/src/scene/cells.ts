// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  InstancedMesh,
  Matrix4,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
} from 'three';
import type { Vector } from '../protocol';

const headerBytes = 20;
const minPointSize = 0.003; // [m] smaller points are not seen from a metre
const pointPerSpacing = 1.5; // points close to a surface, also along the diagonals of a grid
const spacingSamples = 48;

interface Grid {
  origin: Vector;
  step: number; // [m]
  count: number;
  steps: Uint16Array; // three per point
}

/// The header and the steps common to cloud.bin and occupancy.bin; `extra` bytes per point follow.
export function readGrid(file: ArrayBuffer, extra: number): Grid {
  const view = new DataView(file);
  const count = file.byteLength >= headerBytes ? view.getUint32(16, true) : 0;
  if (file.byteLength !== headerBytes + count * (6 + extra))
    throw new Error('file size differs from the header');
  const origin: Vector = [
    view.getFloat32(0, true),
    view.getFloat32(4, true),
    view.getFloat32(8, true),
  ];
  const steps = new Uint16Array(file, headerBytes, 3 * count);
  return { origin, step: view.getFloat32(12, true), count, steps };
}

/// Positions [m] of a grid's points relative to its origin, which keeps float precision.
function positionsOf(grid: Grid): Float32Array {
  return Float32Array.from(grid.steps, (steps) => steps * grid.step);
}

/// sRGB to linear colours, 16 bits, as the GPU blends them.
export function linearColors(srgb: Uint8Array): Uint16Array {
  const table = new Uint16Array(256);
  for (let i = 0; i < 256; ++i) {
    const c = i / 255;
    const linear = c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
    table[i] = Math.round(linear * 65535);
  }
  return Uint16Array.from(srgb, (value) => table[value]);
}

export function makeCloud(file: ArrayBuffer): Points {
  const grid = readGrid(file, 3);
  const srgb = new Uint8Array(file, headerBytes + 6 * grid.count);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positionsOf(grid), 3));
  geometry.setAttribute('color', new BufferAttribute(linearColors(srgb), 3, true));
  const size = Math.max(pointPerSpacing * spacingOf(grid.steps, grid.step), minPointSize);
  const points = new Points(geometry, new PointsMaterial({ size, vertexColors: true }));
  points.position.fromArray(grid.origin);
  return points;
}

/// The colour of a height from the lowest (0) to the highest cell (1): from blue to yellow.
export function heightColor(share: number): Color {
  return new Color().setHSL(0.62 - 0.48 * share, 0.6, 0.32 + 0.13 * share);
}

/// A box for each occupied cell, coloured by height; `userData.heights`: of the lowest and the
/// highest centre [m].
export function makeOccupancy(file: ArrayBuffer): InstancedMesh {
  const { origin, step, count, steps } = readGrid(file, 0);
  const box = new BoxGeometry(0.92 * step, 0.92 * step, 0.92 * step);
  const boxes = new InstancedMesh(box, new MeshLambertMaterial(), count);
  let [low, high] = [Infinity, 0]; // [steps]
  for (let i = 0; i < count; ++i) {
    low = Math.min(low, steps[3 * i + 2]);
    high = Math.max(high, steps[3 * i + 2]);
  }
  const matrix = new Matrix4();
  for (let i = 0; i < count; ++i) {
    const [x, y, z] = [0, 1, 2].map((axis) => origin[axis] + (steps[3 * i + axis] + 0.5) * step);
    boxes.setMatrixAt(i, matrix.makeTranslation(x, y, z));
    boxes.setColorAt(i, heightColor((steps[3 * i + 2] - low) / Math.max(high - low, 1)));
  }
  boxes.userData.heights = [low, high].map((z) => origin[2] + (z + 0.5) * step);
  return boxes;
}

/// The median distance [m] of a point to its nearest neighbour, over some of the points.
export function spacingOf(steps: Uint16Array, step: number): number {
  const count = steps.length / 3;
  const nearest: number[] = [];
  for (let sample = 0; sample < spacingSamples && count > 1; ++sample) {
    const at = Math.floor(((sample + 0.5) * count) / spacingSamples);
    let best = Infinity;
    for (let i = 0; i < count; ++i) {
      const dx = steps[3 * i] - steps[3 * at];
      const dy = steps[3 * i + 1] - steps[3 * at + 1];
      const dz = steps[3 * i + 2] - steps[3 * at + 2];
      const squared = dx * dx + dy * dy + dz * dz;
      if (squared > 0 && squared < best) best = squared;
    }
    if (best < Infinity) nearest.push(best);
  }
  nearest.sort((a, b) => a - b);
  return nearest.length > 0 ? Math.sqrt(nearest[nearest.length >> 1]) * step : 0;
}
