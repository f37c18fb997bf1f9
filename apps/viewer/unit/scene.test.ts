// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  BoxGeometry,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  Ray,
  Raycaster,
  Texture,
  Vector3,
} from 'three';
import { Body } from '../src/scene/bodies';
import { joinedNormals } from '../src/scene/body_outline';
import { isHidden } from '../src/scene/hidden';
import { tagPictureSize } from '../src/scene/marks';
import { DragPlane } from '../src/input/drag_plane';
import { linearColors, readGrid } from '../src/scene/cells';
import { readGlb } from '../src/scene/glb';
import { levelWithin } from '../src/scene/loading';
import { supportBelow } from '../src/scene/plumb_line';
import type { Quaternion, Vector } from '../src/protocol';

function gridFile(points: number[][], extra: number[]): ArrayBuffer {
  const file = new ArrayBuffer(20 + 6 * points.length + extra.length);
  const view = new DataView(file);
  [1, 2, 3, 0.5].forEach((value, i) => view.setFloat32(4 * i, value, true));
  view.setUint32(16, points.length, true);
  points.flat().forEach((value, i) => view.setUint16(20 + 2 * i, value, true));
  new Uint8Array(file).set(extra, 20 + 6 * points.length);
  return file;
}

test('a grid of points is read as written', () => {
  const file = gridFile([[0, 1, 65535]], [10, 20, 30]);
  const grid = readGrid(file, 3);
  assert.deepEqual(grid.origin, [1, 2, 3]);
  assert.equal(grid.step, 0.5);
  assert.deepEqual([...grid.steps], [0, 1, 65535]);
});

test('a grid whose size differs from its header is rejected', () => {
  const file = gridFile([[0, 1, 2]], []);
  assert.throws(() => readGrid(file, 3));
  assert.throws(() => readGrid(file.slice(0, 25), 0));
  assert.throws(() => readGrid(new ArrayBuffer(3), 0));
});

test('sRGB to linear keeps black and white, and maps middle grey to a fifth', () => {
  const [black, grey, white] = linearColors(Uint8Array.of(0, 128, 255));
  assert.equal(black, 0);
  assert.equal(white, 65535);
  assert.ok(Math.abs(grey / 65535 - 0.2159) < 1e-4); // IEC 61966-2-1
});

test('the level shown is the finest within the triangle budget, or else the coarsest', () => {
  const levels = [900, 300, 50].map((triangles) => ({ path: '', triangles, bytes: 0 }));
  assert.equal(levelWithin(levels, 1000), 0);
  assert.equal(levelWithin(levels, 300), 1);
  assert.equal(levelWithin(levels, 10), 2);
  assert.equal(levelWithin([], 10), -1);
});

function glb(json: object, binary: Uint8Array): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const padded = text.length + ((4 - (text.length % 4)) % 4);
  const file = new ArrayBuffer(28 + padded + binary.length);
  const view = new DataView(file);
  view.setUint32(0, 0x46546c67, true);
  view.setUint32(12, padded, true);
  new Uint8Array(file, 20, padded).fill(0x20);
  new Uint8Array(file).set(text, 20);
  view.setUint32(20 + padded, binary.length, true);
  new Uint8Array(file).set(binary, 28 + padded);
  return file;
}

const triangle = {
  scenes: [{ nodes: [0] }],
  nodes: [
    { translation: [0, 0, 5], children: [1] },
    { mesh: 0, scale: [2, 2, 2] },
  ],
  meshes: [{ primitives: [{ attributes: { POSITION: 0, COLOR_0: 1 } }] }],
  accessors: [
    { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3' },
    {
      bufferView: 0,
      componentType: 5121,
      byteOffset: 12,
      count: 3,
      type: 'VEC4',
      normalized: true,
    },
  ],
  bufferViews: [{ buffer: 0, byteLength: 48, byteStride: 16 }],
};

function triangleBytes(): Uint8Array {
  const bytes = new Uint8Array(48);
  const view = new DataView(bytes.buffer);
  view.setFloat32(16, 1, true);
  view.setFloat32(36, 1, true);
  bytes[12] = 255;
  return bytes;
}

test('a triangle with interleaved attributes is read with its node transforms', async () => {
  const [part] = await readGlb(glb(triangle, triangleBytes()));
  const position = part.geometry.getAttribute('position');
  assert.deepEqual([position.getX(1), position.getY(2), position.count], [1, 1, 3]);
  assert.equal(part.geometry.getAttribute('color').getX(0), 1);
  const corner = new Vector3(1, 0, 0).applyMatrix4(part.matrix);
  assert.deepEqual(corner.toArray(), [2, 0, 5]);
  // The file has no normals: they are computed from the triangle.
  assert.equal(part.geometry.getAttribute('normal').getZ(0), 1);
});

test('a file that is not glTF is rejected with a message', async () => {
  await assert.rejects(readGlb(new ArrayBuffer(4)), /not a binary glTF/);
  await assert.rejects(readGlb(new TextEncoder().encode('x'.repeat(40)).buffer), /not a binary/);
  const empty = { ...triangle, accessors: [] };
  await assert.rejects(readGlb(glb(empty, triangleBytes())), /has no data/);
});

function cameraAt(position: Vector3, target: Vector3): PerspectiveCamera {
  const camera = new PerspectiveCamera();
  camera.position.copy(position);
  camera.lookAt(target);
  camera.updateMatrixWorld();
  return camera;
}

function rayTo(camera: PerspectiveCamera, target: Vector3): Ray {
  return new Ray(camera.position.clone(), target.clone().sub(camera.position).normalize());
}

test('a drag on a horizontal plane keeps the height, and the tool under the pointer', () => {
  const tool = new Vector3(0, 0.1, 0);
  const camera = cameraAt(new Vector3(0, 1, 2), tool);
  const plane = DragPlane.through(tool, 'horizontal', camera, rayTo(camera, tool));
  const moved = plane.move(rayTo(camera, new Vector3(0.3, 0.1, -0.2)))!;
  assert.ok(moved.distanceTo(new Vector3(0.3, 0.1, -0.2)) < 1e-9);
});

test('a drag on a vertical plane moves the tool in that plane only', () => {
  const tool = new Vector3(0, 0.1, 0);
  const camera = cameraAt(new Vector3(0, 1, 2), tool);
  const plane = DragPlane.through(tool, 'vertical', camera, rayTo(camera, tool));
  const moved = plane.move(rayTo(camera, new Vector3(0.2, 0.4, 0)))!;
  assert.ok(moved.distanceTo(new Vector3(0.2, 0.4, 0)) < 1e-9);
});

test('a drag on a horizontal plane at grazing incidence moves the tool by little', () => {
  const tool = new Vector3(0, 0.1, 0);
  const camera = cameraAt(new Vector3(0, 0.12, 2), tool);
  const plane = DragPlane.through(tool, 'horizontal', camera, rayTo(camera, tool));
  const moved = plane.move(rayTo(camera, new Vector3(0, 0.13, 0)))!;
  assert.ok(moved.distanceTo(tool) < 0.05);
});

test('a pointer above the horizon does not move the tool', () => {
  const tool = new Vector3(0, 0, 0);
  const camera = cameraAt(new Vector3(0, 1, 2), tool);
  const plane = DragPlane.through(tool, 'horizontal', camera, rayTo(camera, tool));
  assert.equal(plane.move(rayTo(camera, new Vector3(0, 2, 0))), null);
  assert.equal(plane.move(rayTo(camera, new Vector3(0, 0.9, -1))), null);
});

const table: Vector[] = [
  [0, 0, 0.5],
  [2, 0, 0.5],
  [2, 1, 0.5],
  [0, 1, 0.5],
];

test('the support below a tool is the highest one under it', () => {
  const floor = table.map(([x, y]) => [4 * x - 4, 4 * y - 2, 0] as Vector);
  assert.equal(supportBelow([1, 0.5, 1], [floor, table]), 0.5);
  assert.equal(supportBelow([1, 0.5, 0.2], [floor, table]), 0);
  assert.equal(supportBelow([-1, 0.5, 1], [floor, table]), 0);
  assert.equal(supportBelow([1, 0.5, -1], [floor, table]), -Infinity);
  assert.equal(supportBelow([1, 0.5, 1], []), -Infinity);
});

test('a concave support is not below a point in its notch', () => {
  const notched: Vector[] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 1, 0],
    [1, 1, 0],
    [1, 2, 0],
    [0, 2, 0],
  ];
  assert.equal(supportBelow([0.5, 1.5, 1], [notched]), 0);
  assert.equal(supportBelow([1.5, 1.5, 1], [notched]), -Infinity);
});

/// A cube of 0.1 m at x [m].
function cube(name: string, x: number, map: Texture | null = null): Body {
  const quaternion: Quaternion = [0, 0, 0, 1];
  const properties = {
    path: '',
    bytes: 0,
    texture: null,
    mass: 1,
    movable: true,
    evidence: '',
    parameters: {},
  };
  const body = new Body({ name, position: [x, 0, 0], quaternion, ...properties }, 0);
  const geometry = new BoxGeometry(0.1, 0.1, 0.1);
  body.addParts([{ geometry, matrix: new Matrix4(), color: null, hasTexture: map !== null }], map);
  body.solid.updateMatrixWorld(true);
  return body;
}

test('a body behind another one of its size is hidden, one that looks out is not', () => {
  const [front, behind, beside] = [cube('a', 0), cube('b', -0.2), cube('c', 0.3)];
  const all = [front, behind, beside];
  const near = new Vector3(0.2, 0, 0);
  assert.ok(isHidden(behind, [front, behind], near));
  assert.ok(!isHidden(front, [front, behind], near));
  assert.ok(!isHidden(behind, all, new Vector3(0.2, 0, 0.4)), 'seen over the other');
  assert.ok(!isHidden(behind, [behind], near));
  // Bodies that touch: each has a side that is seen.
  assert.ok(!isHidden(cube('d', 0.1), [front, cube('d', 0.1)], new Vector3(0.1, 1, 0)));
});

test('the corners of an outline point away from the body, with all their faces', () => {
  const box = new BoxGeometry(0.1, 0.1, 0.1);
  const joined = joinedNormals(box);
  const { position } = box.attributes;
  for (let i = 0; i < position.count; ++i) {
    const corner = new Vector3().fromBufferAttribute(position, i).normalize();
    const normal = new Vector3().fromBufferAttribute(joined, i);
    assert.ok(normal.distanceTo(corner) < 1e-5, `vertex ${i}`);
  }
});

test('a body with a texture is drawn with it, outlined in its colour, pointed at as one', () => {
  const map = new Texture();
  const body = cube('a', 0, map);
  const meshes = body.solid.children.filter((child): child is Mesh => child instanceof Mesh);
  const materials = meshes.map(({ material }) => material as MeshBasicMaterial);
  assert.deepEqual(
    materials.map((material) => material.map),
    [map, null],
  );
  assert.equal(`#${materials[1].color.getHexString()}`, body.color);
  const edges = body.solid.children.find((child) => child instanceof LineSegments)!;
  const edgeColor = () =>
    ((edges as LineSegments).material as LineBasicMaterial).color.getHexString();
  assert.equal(`#${edgeColor()}`, body.color);
  body.setPhase('sliding', false);
  assert.notEqual(`#${edgeColor()}`, body.color, 'its edges show its phase');
  const ray = new Raycaster(new Vector3(1, 0.01, 0.02), new Vector3(-1, 0, 0));
  assert.equal(
    ray.intersectObject(body.solid).filter(({ object }) => object instanceof Mesh).length,
    1,
  );
  const painted = cube('b', 0).solid.children.filter((child) => child instanceof Mesh);
  assert.equal(painted.length, 1, 'without a texture there is no outline');
});

test('the pictures of any number of tags have one bound', () => {
  const bytes = (tags: number) => (tags * tagPictureSize(tags) ** 2 * 4 * 4) / 3;
  for (let tags = 0; tags < 2000; ++tags) assert.ok(bytes(tags) <= 1024 * 1024, `${tags} tags`);
  assert.equal(tagPictureSize(6), 128);
  assert.equal(tagPictureSize(240), 16); // six on each of 40 bodies
});
