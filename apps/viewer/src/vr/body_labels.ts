// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferAttribute,
  BufferGeometry,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  Vector3,
} from 'three';
import { phaseColors } from '../palette';
import type { Body } from '../scene/bodies';
import { drawnTexture } from '../scene/drawn_texture';
import { phaseLabel } from '../ui/objects_panel';
import type { BodySizes } from './body_sizes';

const maxLabels = 8; // more would hide the scene
const pixels = { x: 320, y: 40 }; // of a label
const angle = 0.2; // [rad] of a label's width
const gap = 0.012; // [rad] above the body
const corners = [
  [-0.5, 0],
  [0.5, 0],
  [0.5, 1],
  [-0.5, 1],
] as const;

/// Names and phases above the movable bodies, facing the head, each as wide at any distance. One
/// mesh: a draw call for all.
export class BodyLabels {
  readonly mesh: Mesh;
  readonly texts: string[] = []; // shown
  private readonly sheet = drawnTexture(pixels.x, maxLabels * pixels.y);
  private readonly places = new BufferAttribute(new Float32Array(maxLabels * 4 * 3), 3);

  constructor() {
    const { texture } = this.sheet;
    texture.generateMipmaps = false;
    texture.minFilter = LinearFilter;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', this.places);
    geometry.setAttribute('uv', new BufferAttribute(textureCorners(), 2));
    const rows = Array.from({ length: maxLabels }, (_, i) => 4 * i);
    geometry.setIndex(rows.flatMap((at) => [at, at + 1, at + 2, at, at + 2, at + 3]));
    const material = new MeshBasicMaterial({ map: texture, toneMapped: false, transparent: true });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false; // it moves with its vertices
    this.mesh.name = 'labels';
  }

  /// Once a frame, in the headset's space.
  update(bodies: readonly Body[], sizes: BodySizes, head: Vector3): void {
    const shown = bodies.slice(0, maxLabels);
    this.mesh.geometry.setDrawRange(0, 6 * shown.length);
    this.texts.length = shown.length;
    shown.forEach((body, i) => {
      const text = `${body.object.name} · ${phaseLabel(body)}`;
      if (text !== this.texts[i]) this.draw(i, text, body);
      this.texts[i] = text;
      this.place(i, sizes.top(body), head);
    });
    this.places.needsUpdate = true;
  }

  private place(row: number, top: Vector3, head: Vector3): void {
    const away = top.clone().sub(head);
    const distance = away.length();
    const right = new Vector3(-away.z, 0, away.x).normalize();
    const up = right.clone().cross(away).normalize();
    const width = angle * distance;
    const height = (width * pixels.y) / pixels.x;
    corners.forEach(([x, y], corner) => {
      const at = top.clone().addScaledVector(right, x * width);
      at.addScaledVector(up, y * height + gap * distance);
      this.places.setXYZ(4 * row + corner, at.x, at.y, at.z);
    });
  }

  private draw(row: number, text: string, body: Body): void {
    const { pen, texture } = this.sheet;
    const top = row * pixels.y;
    pen.font = '600 26px system-ui, sans-serif';
    const wide = Math.min(pixels.x, pen.measureText(text).width + 56);
    const left = (pixels.x - wide) / 2;
    pen.clearRect(0, top, pixels.x, pixels.y);
    pen.fillStyle = 'rgb(16 22 29 / 80%)';
    pen.fillRect(left, top, wide, pixels.y);
    pen.fillStyle = body.isKnown ? phaseColors[body.phase] : 'transparent';
    pen.fillRect(left + 12, top + 12, 16, 16);
    pen.fillStyle = '#ffffff';
    pen.fillText(text, left + 38, top + 29, wide - 50);
    texture.needsUpdate = true;
  }
}

/// Each label's part of the texture.
function textureCorners(): Float32Array {
  const places: number[] = [];
  for (let row = 0; row < maxLabels; ++row)
    for (const [x, y] of corners) places.push(x + 0.5, 1 - (row + 1 - y) / maxLabels);
  return new Float32Array(places);
}
