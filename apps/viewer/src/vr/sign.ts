// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, type Quaternion, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';

// Above the line of sight: the bodies are below it; near enough to be read [m].
const signOffset = new Vector3(0, 0.2, -0.9);
const size = { x: 0.42, y: 0.084 };
const pixels = { x: 840, y: 168 };
const textWidth = pixels.x - 30; // wider lines are condensed

/// What the user has to know at once, the most urgent first.
export interface Trouble {
  isLost: boolean;
  isSlow: boolean; // frames take too long to see a motion
  isOutsideModel: boolean;
  isRefused: boolean; // the tool is in use elsewhere
  isOnHold: boolean;
}

/// The sign's two lines; null if all is well.
export function signText(trouble: Trouble): readonly [string, string] | null {
  if (trouble.isLost) return ['CONNECTION LOST', 'the last known state is shown'];
  if (trouble.isSlow)
    return ['SLOW PICTURE', 'frames take too long: show fewer layers or less detail'];
  if (trouble.isOutsideModel) return ['OUTSIDE THE MODEL', 'a body moved as it was not foreseen'];
  if (trouble.isRefused) return ['TOOL IN USE', 'by another page; TAKE on the panel asks for it'];
  if (trouble.isOnHold) return ['PAUSED', 'A, X or PAUSE on the panel continues'];
  return null;
}

/// A head-locked sign.
export class Sign {
  readonly mesh: Mesh;
  text = ''; // shown; empty: none
  private readonly sheet = drawnTexture(pixels.x, pixels.y);

  constructor() {
    this.mesh = new Mesh(
      new PlaneGeometry(size.x, size.y),
      // Without depth test: visible even with the head inside a wall.
      new MeshBasicMaterial({ map: this.sheet.texture, toneMapped: false, depthTest: false }),
    );
    this.mesh.renderOrder = 10;
    this.mesh.name = 'sign';
    this.mesh.visible = false;
  }

  /// The head's pose in the headset's space.
  show(trouble: Trouble, head: Vector3, rotation: Quaternion): void {
    const lines = signText(trouble);
    this.mesh.visible = lines !== null;
    if (lines && lines[0] !== this.text) this.draw(lines);
    this.text = lines?.[0] ?? '';
    this.mesh.position.copy(signOffset).applyQuaternion(rotation).add(head);
    this.mesh.quaternion.copy(rotation);
  }

  private draw([title, more]: readonly [string, string]): void {
    const { pen, texture } = this.sheet;
    pen.fillStyle = '#ff8a1f';
    pen.fillRect(0, 0, pixels.x, pixels.y);
    pen.fillStyle = '#10161d';
    pen.textAlign = 'center';
    pen.font = '700 76px system-ui, sans-serif';
    pen.fillText(title, pixels.x / 2, 84, textWidth);
    pen.font = '600 36px system-ui, sans-serif';
    pen.fillText(more, pixels.x / 2, 142, textWidth);
    texture.needsUpdate = true;
  }
}
