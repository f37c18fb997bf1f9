// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  Quaternion,
  Vector3,
} from 'three';
import { drawnTexture } from '../scene/drawn_texture';

const outOfView = 0.6; // [rad] from the middle of the view: less is seen without turning
const offset = new Vector3(0, -0.24, -0.9); // [m] below the line of sight
const size = { x: 0.12, y: 0.04 }; // [m]
const pixels = { x: 240, y: 80 };
const arrowGap = 0.015; // [m] beside the text
const arrowHalf = 0.014; // [m]

/// In which direction of the view, counterclockwise from its right [rad], a place is; null where it is
/// in view. All in the headset's space.
export function directionInView(
  place: Vector3,
  head: Vector3,
  rotation: Quaternion,
): number | null {
  const seen = place.clone().sub(head).applyQuaternion(rotation.clone().invert());
  if (seen.angleTo(new Vector3(0, 0, -1)) < outOfView) return null;
  return Math.atan2(seen.y, seen.x);
}

/// "robot" with an arrow, where the robot is out of view.
export class RobotArrow {
  readonly group = new Group();
  private readonly arrow: Mesh;

  constructor() {
    const { pen, texture } = drawnTexture(pixels.x, pixels.y);
    pen.fillStyle = '#10161d';
    pen.fillRect(0, 0, pixels.x, pixels.y);
    pen.fillStyle = '#ffffff';
    pen.textAlign = 'center';
    pen.font = '600 44px system-ui, sans-serif';
    pen.fillText('robot', pixels.x / 2, 55);
    // Without depth test: visible through what is nearer than the text.
    const flat = { toneMapped: false, depthTest: false, side: DoubleSide };
    const text = new Mesh(
      new PlaneGeometry(size.x, size.y),
      new MeshBasicMaterial({ map: texture, ...flat }),
    );
    const triangle = new BufferGeometry().setFromPoints([
      new Vector3(2 * arrowHalf, 0, 0),
      new Vector3(0, arrowHalf, 0),
      new Vector3(0, -arrowHalf, 0),
    ]);
    this.arrow = new Mesh(triangle, new MeshBasicMaterial({ color: '#ffb300', ...flat }));
    this.group.add(text, this.arrow);
    for (const mesh of [text, this.arrow]) mesh.renderOrder = 9; // below the sign
    this.group.name = 'robot arrow';
    this.group.visible = false;
  }

  /// The head's pose, and the robot's base, in the headset's space.
  show(robot: Vector3, head: Vector3, rotation: Quaternion): void {
    const direction = directionInView(robot, head, rotation);
    this.group.visible = direction !== null;
    if (direction === null) return;
    this.group.position.copy(offset).applyQuaternion(rotation).add(head);
    this.group.quaternion.copy(rotation);
    const reach = new Vector3(Math.cos(direction), Math.sin(direction), 0);
    const beside = new Vector3(size.x / 2 + arrowGap, size.y / 2 + arrowGap, 0);
    this.arrow.position.copy(reach.multiply(beside));
    this.arrow.rotation.z = direction;
  }
}
