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
const pointSize = 0.006; // [m] slightly above the default voxel (5 mm): points close to a surface

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
  const points = new Points(geometry, new PointsMaterial({ size: pointSize, vertexColors: true }));
  points.position.fromArray(grid.origin);
  return points;
}

/// A box for each occupied cell, coloured by height, from blue to yellow.
export function makeOccupancy(file: ArrayBuffer): InstancedMesh {
  const { origin, step, count, steps } = readGrid(file, 0);
  const box = new BoxGeometry(0.92 * step, 0.92 * step, 0.92 * step);
  const boxes = new InstancedMesh(box, new MeshLambertMaterial(), count);
  let maxZ = 1; // [steps]
  for (let i = 0; i < count; ++i) maxZ = Math.max(maxZ, steps[3 * i + 2]);
  const matrix = new Matrix4();
  for (let i = 0; i < count; ++i) {
    const [x, y, z] = [0, 1, 2].map((axis) => origin[axis] + (steps[3 * i + axis] + 0.5) * step);
    boxes.setMatrixAt(i, matrix.makeTranslation(x, y, z));
    const height = steps[3 * i + 2] / maxZ;
    boxes.setColorAt(i, new Color().setHSL(0.62 - 0.48 * height, 0.6, 0.32 + 0.13 * height));
  }
  return boxes;
}
