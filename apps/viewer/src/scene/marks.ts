// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  AxesHelper,
  BufferGeometry,
  type CanvasTexture,
  DoubleSide,
  EdgesGeometry,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  LineLoop,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  Shape,
  ShapeGeometry,
  Vector3,
} from 'three';
import { drawnTexture } from './drawn_texture';
import { heightOf, type Outline } from './outline';
import type { SceneModel, SceneTag } from './scene_model';
import type { SceneView } from './view';

const lift = 0.001; // [m] above the surface, against z-fighting
const cameraSize = 0.02; // [m]
const maxCameras = 60; // drawn as pyramids: more would hide the path they lie on
const tagSizes = [128, 64, 32, 16]; // [px]
const maxTagBytes = 1024 * 1024; // of a headset's memory for all textures, 16 MiB

/// Adds tags, coordinate frames, support planes and the camera path.
export function addMarks(view: SceneView, model: SceneModel): void {
  const { layers } = view;
  layers.group('frames').add(axes(0.2));
  for (const { marks } of view.bodies) {
    const [tags, frame] = marks;
    frame.add(axes(0.08));
    layers.group('tags').add(tags);
    layers.group('frames').add(frame);
  }
  const size = tagPictureSize(model.tags.length);
  for (const tag of model.tags) addTag(view, tag, size);
  for (const { outline } of model.support_planes)
    if (outline.length > 2) layers.group('planes').add(supportPlane(outline));
  for (const guard of model.guards) layers.group('guards').add(guardSurface(guard));
  for (const part of cameraPath(model.cameras)) layers.group('cameras').add(part);
}

function axes(length: number): AxesHelper {
  return new AxesHelper(length);
}

/// Edge of each tag's picture [px]: smaller where they are many, as all together have a bound.
export function tagPictureSize(tags: number): number {
  const bytes = (size: number) => tags * size * size * 4 * (4 / 3); // with mipmaps
  return tagSizes.find((size) => bytes(size) <= maxTagBytes) ?? 0;
}

function addTag(view: SceneView, tag: SceneTag, size: number): void {
  const mark = new Group();
  const map = size > 0 ? tagPicture(tag, size) : null;
  const square = new Mesh(
    new PlaneGeometry(tag.size, tag.size),
    new MeshBasicMaterial({ map, side: DoubleSide }),
  );
  square.position.z = lift;
  mark.add(square, axes(0.6 * tag.size));
  mark.position.fromArray(tag.position);
  mark.quaternion.fromArray(tag.quaternion);
  if (tag.object === null) view.layers.group('tags').add(mark);
  else view.body(tag.object)?.marks[0].add(mark);
}

/// A tag's family and id in a border; the tag's bit pattern is not drawn.
function tagPicture(tag: SceneTag, size: number): CanvasTexture {
  const { pen, texture } = drawnTexture(size, size);
  pen.scale(size / 128, size / 128);
  pen.fillStyle = '#ffffff';
  pen.fillRect(0, 0, 128, 128);
  pen.lineWidth = 12;
  pen.strokeRect(10, 10, 108, 108);
  pen.fillStyle = '#000000';
  pen.textAlign = 'center';
  pen.font = '600 52px sans-serif';
  pen.fillText(String(tag.id), 64, 78);
  pen.font = '14px sans-serif';
  pen.fillText(tag.family, 64, 102);
  return texture;
}

/// A filled polygon at the outline's mean height, with its edge.
function supportPlane(outline: Outline): Group {
  const corners = outline.map((corner) => new Vector3(...corner));
  const shape = new Shape();
  corners.forEach(({ x, y }, i) => (i === 0 ? shape.moveTo(x, y) : shape.lineTo(x, y)));
  const face = new Mesh(
    new ShapeGeometry(shape),
    new MeshBasicMaterial({
      color: '#2f9e6e',
      transparent: true,
      opacity: 0.25,
      depthWrite: false,
      side: DoubleSide,
    }),
  );
  face.position.z = heightOf(outline) + lift;
  const edge = new LineLoop(
    new BufferGeometry().setFromPoints(corners),
    new LineBasicMaterial({ color: '#2f9e6e' }),
  );
  edge.position.z = lift;
  return new Group().add(face, edge);
}

const guardColor = '#c23b4e';

/// A translucent surface with its creases as lines.
function guardSurface(guard: SceneModel['guards'][number]): Group {
  const geometry = new BufferGeometry();
  const positions = guard.vertices_mm.map((coordinate) => coordinate / 1000);
  geometry.setAttribute('position', new Float32BufferAttribute(positions, 3));
  geometry.setIndex(guard.triangles);
  geometry.computeVertexNormals();
  const face = new Mesh(
    geometry,
    new MeshBasicMaterial({
      color: guardColor,
      transparent: true,
      opacity: 0.18,
      depthWrite: false,
      side: DoubleSide,
    }),
  );
  const edges = new LineSegments(
    new EdgesGeometry(geometry, 40),
    new LineBasicMaterial({ color: guardColor, transparent: true, opacity: 0.6 }),
  );
  const group = new Group().add(face, edges);
  group.name = guard.name;
  return group;
}

function cameraPath(cameras: SceneModel['cameras']): (Line | LineSegments)[] {
  const material = new LineBasicMaterial({ color: '#b8860b' });
  const path = cameras.map(({ position }) => new Vector3(...position));
  const parts: (Line | LineSegments)[] = [];
  if (path.length > 1) parts.push(new Line(new BufferGeometry().setFromPoints(path), material));
  const pyramid = new BufferGeometry().setFromPoints(pyramidEdges(cameraSize));
  const every = Math.ceil(cameras.length / maxCameras);
  for (let i = 0; i < cameras.length; i += every) {
    const camera = new LineSegments(pyramid, material);
    camera.position.fromArray(cameras[i].position);
    camera.quaternion.fromArray(cameras[i].quaternion);
    parts.push(camera);
  }
  return parts;
}

/// A camera looks along its z, with x to the right and y down.
function pyramidEdges(size: number): Vector3[] {
  const corner = (x: number, y: number) => new Vector3(x * size, y * size * 0.75, 1.5 * size);
  const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
  return corners.flatMap((c, i) => [new Vector3(), c, c, corners[(i + 1) % 4]]);
}
