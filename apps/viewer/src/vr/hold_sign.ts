// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, type Quaternion, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';

// Below the line of sight, out of the way of what is looked at, near enough to be read [m].
const ahead = new Vector3(0, -0.22, -0.9);
const size = { x: 0.3, y: 0.06 };

/// Says in front of the eyes that commands are on hold, wherever the person looks.
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
      // In front of everything: it has to be seen also with the head in a wall.
      new MeshBasicMaterial({ map: texture, toneMapped: false, depthTest: false }),
    );
    this.mesh.renderOrder = 10;
    this.mesh.name = 'hold sign';
    this.mesh.visible = false;
  }

  /// `head` and `turn` in the headset's space.
  show(isOnHold: boolean, head: Vector3, turn: Quaternion): void {
    this.mesh.visible = isOnHold;
    this.mesh.position.copy(ahead).applyQuaternion(turn).add(head);
    this.mesh.quaternion.copy(turn);
  }
}
