// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  DoubleSide,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  type Color,
  type Material,
  type Texture,
} from 'three';
import type { GlbPart } from './glb';
import { seeThrough } from './see_through';

/// Scanned colours contain the light already (unlit material); a plain surface needs shading.
function scanMaterial(hasColors: boolean, color: Color | null, map: Texture | null): Material {
  if (map) return seeThrough(new MeshBasicMaterial({ map, side: DoubleSide }));
  if (hasColors) return seeThrough(new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
  return seeThrough(new MeshLambertMaterial({ color: color ?? '#b8bec6', side: DoubleSide }));
}

/// A part of the scan, as it is drawn.
export function scanMesh({ geometry, matrix, color }: GlbPart, map: Texture | null): Mesh {
  const mesh = new Mesh(geometry, scanMaterial(geometry.hasAttribute('color'), color, map));
  mesh.matrixAutoUpdate = false;
  mesh.matrix.copy(matrix);
  return mesh;
}
