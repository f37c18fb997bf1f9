// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  CircleGeometry,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  Vector3,
} from 'three';

// [m]
const footprint = 0.1; // radius: bases of table-top arms have 0.08 to 0.12
const rim = 0.006;
const axisLength = 0.16;
const axisRadius = 0.004;
const headLength = 0.03;
const lift = 0.002; // above a table at the height of the base, against z-fighting

const footprintColor = '#5b6570';
const axes = [
  { direction: new Vector3(1, 0, 0), color: '#d2393c' },
  { direction: new Vector3(0, 1, 0), color: '#2f9440' },
  { direction: new Vector3(0, 0, 1), color: '#2f63c9' },
] as const;

/// Where a robot stands: its footprint, as a disc of 0.2 m, and the axes of its base: x red, y green,
/// z blue.
export function makeRobotGlyph(): Group {
  const glyph = new Group();
  glyph.name = 'robot base';
  const flat = { color: footprintColor, side: DoubleSide };
  const disc = new Mesh(
    new CircleGeometry(footprint - rim, 48),
    new MeshBasicMaterial({ ...flat, transparent: true, opacity: 0.3, depthWrite: false }),
  );
  const edge = new Mesh(
    new RingGeometry(footprint - rim, footprint, 48),
    new MeshBasicMaterial(flat),
  );
  for (const part of [disc, edge]) part.position.z = lift;
  glyph.add(disc, edge);
  for (const { direction, color } of axes) glyph.add(makeAxis(direction, color));
  return glyph;
}

/// An arrow from the origin; three.js's cylinders and cones point along y.
function makeAxis(direction: Vector3, color: string): Group {
  const material = new MeshBasicMaterial({ color });
  const shaft = axisLength - headLength;
  const line = new Mesh(new CylinderGeometry(axisRadius, axisRadius, shaft, 12), material);
  line.position.y = shaft / 2;
  const head = new Mesh(new ConeGeometry(3 * axisRadius, headLength, 16), material);
  head.position.y = shaft + headLength / 2;
  const axis = new Group().add(line, head);
  axis.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
  return axis;
}
