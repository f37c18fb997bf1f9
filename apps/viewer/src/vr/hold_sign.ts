// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, type Quaternion, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';

// Below the line of sight, clear of the scene's centre, near enough to be read [m].
const signOffset = new Vector3(0, -0.22, -0.9);
const size = { x: 0.3, y: 0.06 };

/// A head-locked sign that commands are on hold.
export class HoldSign {
  readonly mesh: Mesh;

  constructor() {
    const { pen, texture } = drawnTexture(640, 128);
    pen.fillStyle = '#ff8a1f';
    pen.fillRect(0, 0, 640, 128);
    pen.fillStyle = '#10161d';
    pen.font = '700 72px system-ui, sans-serif';
    pen.textAlign = 'center';
    pen.fillText('ON HOLD', 320, 90);
    this.mesh = new Mesh(
      new PlaneGeometry(size.x, size.y),
      // Without depth test: visible even with the head inside a wall.
      new MeshBasicMaterial({ map: texture, toneMapped: false, depthTest: false }),
    );
    this.mesh.renderOrder = 10;
    this.mesh.name = 'hold sign';
    this.mesh.visible = false;
  }

  /// The head's pose in the headset's space.
  show(isOnHold: boolean, head: Vector3, rotation: Quaternion): void {
    this.mesh.visible = isOnHold;
    this.mesh.position.copy(signOffset).applyQuaternion(rotation).add(head);
    this.mesh.quaternion.copy(rotation);
  }
}
