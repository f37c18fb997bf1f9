// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A scanned cup as the scene's mesh, and how deep it is inside a box.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const spacing = 0.004; // [m] between the scan's vertices

/// Vertices [m] and triangles of an open cup that stands on z = 0: a thin wall with two sides.
function makeCup([x, y], radius, height) {
  const around = Math.ceil((2 * Math.PI * radius) / spacing);
  const levels = Math.ceil(height / spacing);
  const vertices = [];
  const triangles = [];
  for (const [r, isOutside] of [
    [radius, true],
    [radius - 0.003, false],
  ]) {
    const first = vertices.length;
    const at = (i, k) => first + (i % around) * (levels + 1) + k;
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      for (let k = 0; k <= levels; ++k) {
        vertices.push([x + r * Math.cos(angle), y + r * Math.sin(angle), (height * k) / levels]);
      }
      for (let k = 0; k < levels; ++k) {
        const [a, b, c, d] = [at(i, k), at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)];
        triangles.push(...(isOutside ? [[a, b, c], [c, b, d]] : [[a, c, b], [c, d, b]])); // prettier-ignore
      }
    }
  }
  return { vertices, triangles };
}

/// Gives a scene without a scan one of a cup, and returns the scan's vertices [m].
export function putCup(scene, centre, radius, height) {
  const { vertices, triangles } = makeCup(centre, radius, height);
  const header = [
    ...['ply', 'format ascii 1.0', `element vertex ${vertices.length}`],
    ...['x', 'y', 'z'].map((name) => `property float ${name}`),
    ...[`element face ${triangles.length}`, 'property list uchar int vertex_indices', 'end_header'],
  ];
  const lines = [
    ...vertices.map((vertex) => vertex.join(' ')),
    ...triangles.map((triangle) => `3 ${triangle.join(' ')}`),
  ];
  writeFileSync(join(scene, 'mesh.ply'), `${[...header, ...lines].join('\n')}\n`);
  const manifest = join(scene, 'scene.yaml');
  const text = readFileSync(manifest, 'utf8');
  writeFileSync(manifest, text.replace('frames_used: 0', 'frames_used: 1')); // it has a scan
  return vertices;
}

/// Half the edges [m] of a box around the origin of an OBJ file.
export function halfEdges(file) {
  const corners = readFileSync(file, 'utf8')
    .split('\n')
    .filter((line) => line.startsWith('v '))
    .map((line) => line.split(' ').slice(1, 4).map(Number));
  return [0, 1, 2].map((k) => Math.max(...corners.map((corner) => corner[k])));
}

/// Depth [m] of the deepest point inside a box at a pose; negative: all are outside.
export function deepest(points, { position, quaternion: [qx, qy, qz, qw] }, half) {
  // R^T (p - t), row by row.
  const axes = [
    [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy + qz * qw), 2 * (qx * qz - qy * qw)],
    [2 * (qx * qy - qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz + qx * qw)],
    [2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw), 1 - 2 * (qx * qx + qy * qy)],
  ];
  const depthOf = (point) =>
    Math.min(
      ...axes.map((axis, k) => {
        const along = axis.reduce((sum, a, i) => sum + a * (point[i] - position[i]), 0);
        return half[k] - Math.abs(along);
      }),
    );
  return points.reduce((depth, point) => Math.max(depth, depthOf(point)), -Infinity);
}
