// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Mesh,
  Vector3,
  type MeshBasicMaterial,
} from 'three';

const width = 0.006; // of half the picture's height: 2.4 pixels of 800, whatever the distance

/// The normals of a mesh, averaged over the vertices that are at the same place: those of a sharp edge
/// are split, and would move apart.
export function joinedNormals(geometry: BufferGeometry): BufferAttribute {
  const { position, normal } = geometry.attributes;
  const sums = new Map<string, Vector3>();
  const keys: string[] = [];
  for (let i = 0; i < position.count; ++i) {
    const key = [position.getX(i), position.getY(i), position.getZ(i)]
      .map((value) => Math.round(value * 1e5)) // [10 um]
      .join();
    keys.push(key);
    const sum = sums.get(key) ?? new Vector3();
    sums.set(key, sum.add(new Vector3(normal.getX(i), normal.getY(i), normal.getZ(i))));
  }
  for (const sum of sums.values()) sum.normalize();
  const joined = new Float32Array(3 * position.count);
  keys.forEach((key, i) => sums.get(key)!.toArray(joined, 3 * i));
  return new BufferAttribute(joined, 3);
}

/// The silhouette of a body: its back faces, moved outwards by the line's width on the picture.
export function outlineMesh(geometry: BufferGeometry, material: MeshBasicMaterial): Mesh {
  const hull = new BufferGeometry();
  hull.setIndex(geometry.index);
  hull.setAttribute('position', geometry.attributes.position);
  hull.setAttribute('normal', joinedNormals(geometry));
  material.side = BackSide;
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace(
      '#include <project_vertex>',
      /* glsl */ `
#include <project_vertex>
vec2 outward = (mat3(modelViewMatrix) * normal).xy;
outward /= max(length(outward), 1e-6);
outward.x *= projectionMatrix[0][0] / projectionMatrix[1][1];
gl_Position.xy += ${width} * gl_Position.w * outward;`,
    );
  };
  const mesh = new Mesh(hull, material);
  mesh.name = 'outline';
  mesh.raycast = () => undefined; // what is pointed at is the body
  return mesh;
}
