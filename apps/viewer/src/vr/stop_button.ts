// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';
import { Press } from './press';

const width = 0.16; // [m] as the panel
const height = 0.045; // [m]
const gap = 0.008; // [m] to the panel
const pixels = { x: 512, y: 144 };
// Hysteresis of a fingertip's distance [m], as of the panel's buttons.
const pressDistance = 0.012;
const releaseDistance = 0.035;
const confirmMs = 3000; // in which a second press confirms a release

/// What it adds to the panel's height [m].
export const stopButtonHeight = gap + height;

/// The emergency stop above the panel: one touch stops, two touches release.
export class StopButton {
  readonly mesh: Mesh;
  private readonly sheet = drawnTexture(pixels.x, pixels.y);
  private readonly pressed = new Press();
  private shown = '';
  private confirmUntil = 0; // [ms] a release was pressed once; 0: not

  /// `panelHeight` [m]: it is a child of the panel.
  constructor(panelHeight: number) {
    this.mesh = new Mesh(
      new PlaneGeometry(width, height),
      new MeshBasicMaterial({ map: this.sheet.texture, toneMapped: false }),
    );
    this.mesh.name = 'emergency-stop';
    this.mesh.position.set(0, panelHeight / 2 + gap + height / 2, 0);
    this.draw(false, false);
  }

  /// Once a frame: what a fingertip (world frame) asks for. `now` in milliseconds.
  update(
    tip: Vector3 | undefined,
    isStopped: boolean,
    now: number,
  ): 'stop' | 'release' | undefined {
    if (now > this.confirmUntil) this.confirmUntil = 0;
    const isTouched = this.pressed.update(
      this.isAt(tip, pressDistance),
      this.isAt(tip, releaseDistance),
    );
    const isConfirmed = isTouched && this.confirmUntil > 0;
    if (isTouched) this.confirmUntil = isStopped && !isConfirmed ? now + confirmMs : 0;
    this.draw(isStopped, this.confirmUntil > 0);
    if (!isTouched) return undefined;
    if (!isStopped) return 'stop';
    return isConfirmed ? 'release' : undefined;
  }

  private isAt(tip: Vector3 | undefined, distance: number): boolean {
    if (!tip) return false;
    this.mesh.updateWorldMatrix(true, false);
    const { x, y, z } = this.mesh.worldToLocal(tip.clone());
    return Math.abs(x) < width / 2 && Math.abs(y) < height / 2 && Math.abs(z) < distance;
  }

  private draw(isStopped: boolean, isAsking: boolean): void {
    const text = isAsking ? 'RELEASE: SURE?' : isStopped ? 'STOPPED' : 'STOP';
    if (text === this.shown) return;
    this.shown = text;
    const c = this.sheet.pen;
    c.fillStyle = isStopped ? '#ffc14d' : '#b3261e';
    c.fillRect(0, 0, pixels.x, pixels.y);
    c.fillStyle = isStopped ? '#10161d' : '#ffffff';
    c.font = '700 56px system-ui, sans-serif';
    c.textAlign = 'center';
    c.fillText(text, pixels.x / 2, 92, pixels.x - 16);
    this.sheet.texture.needsUpdate = true;
  }
}
