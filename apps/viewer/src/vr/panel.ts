// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, type Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';
import { Press } from './press';

/// The content of the panel.
export interface PanelText {
  object: string; // touched: a body's name, "scan", or empty
  phase: string;
  force: number; // [N]
  age: number; // [s] of the newest state; NaN before the first
  isOnHold: boolean;
  note: string; // the interlock that keeps the clutch open, or empty
  scale: number;
}

export type PanelButton = 'hold' | 'reset';

const width = 512;
const height = 336;
// The panel's width: 0.3 mm a pixel is readable at arm's length in a headset [m].
const metres = 0.16;
// The state age from which the number is red: six frames at 60 Hz [s].
const staleAge = 0.1;
// Redraw interval of numbers: faster can't be read, and each redraw uploads a texture [ms].
const redrawMs = 150;
// The buttons, in pixels from the panel's upper left corner.
const buttonTop = 236;
const buttonHeight = 84;
const buttons: { name: PanelButton; x: number; width: number }[] = [
  { name: 'hold', x: 16, width: 264 },
  { name: 'reset', x: 296, width: 200 },
];
// Hysteresis of a fingertip's distance to a button [m].
const pressDistance = 0.012;
const releaseDistance = 0.035;

/// A small panel at the free hand, with state, force and two touch buttons.
export class Panel {
  readonly mesh: Mesh;
  private readonly sheet = drawnTexture(width, height);
  private readonly pressed = new Press();
  private shownText = '';
  private shownNumbers = '';
  private drawnAt = 0; // [ms]

  constructor() {
    this.mesh = new Mesh(
      new PlaneGeometry(metres, (metres * height) / width),
      new MeshBasicMaterial({ map: this.sheet.texture, toneMapped: false }),
    );
    this.mesh.name = 'panel';
  }

  /// Above a hand, facing the head; all in the headset's space.
  placeAbove(hand: Vector3, head: Vector3): void {
    this.mesh.position.copy(hand);
    this.mesh.position.y += 0.12;
    const towards = head.clone().sub(this.mesh.position);
    const flat = Math.hypot(towards.x, towards.z);
    this.mesh.rotation.set(
      -Math.atan2(towards.y, flat),
      Math.atan2(towards.x, towards.z),
      0,
      'YXZ',
    );
    this.mesh.updateMatrix();
  }

  /// Redraws what has changed: text at once, numbers at a readable rate. `now` in milliseconds.
  show(text: PanelText, now: number): void {
    const withoutNumbers = JSON.stringify({ ...text, force: 0, age: 0 });
    const numbers = `${text.force.toFixed(1)} ${Math.round(text.age * 100)}`;
    const isDue = now - this.drawnAt > redrawMs && numbers !== this.shownNumbers;
    if (withoutNumbers === this.shownText && !isDue) return;
    this.shownText = withoutNumbers;
    this.shownNumbers = numbers;
    this.drawnAt = now;
    this.draw(text);
    this.sheet.texture.needsUpdate = true;
  }

  /// The button that a fingertip (headset frame) has just touched; once per touch.
  pressedBy(tip: Vector3 | undefined): PanelButton | undefined {
    const near = tip && this.buttonAt(tip, pressDistance);
    const isClose = tip !== undefined && this.buttonAt(tip, releaseDistance) !== undefined;
    return this.pressed.update(near !== undefined, isClose) ? near : undefined;
  }

  private buttonAt(tip: Vector3, distance: number): PanelButton | undefined {
    const local = tip.clone().applyMatrix4(this.mesh.matrix.clone().invert());
    const x = (local.x / metres + 0.5) * width;
    const y = height / 2 - (local.y / metres) * width;
    if (Math.abs(local.z) > distance || y < buttonTop || y > buttonTop + buttonHeight) {
      return undefined;
    }
    return buttons.find((b) => x > b.x && x < b.x + b.width)?.name;
  }

  private draw(text: PanelText): void {
    const c = this.sheet.pen;
    c.fillStyle = text.isOnHold ? '#5a1e00' : '#10161d';
    c.fillRect(0, 0, width, height);
    c.strokeStyle = '#48627a';
    c.lineWidth = 6;
    c.strokeRect(3, 3, width - 6, height - 6);
    this.line(text.object || 'no contact', 48, 34, '#9fb3c8');
    this.line(text.phase, 116, 56, '#ffffff');
    this.line(`${text.force.toFixed(1)} N`, 116, 56, '#ffffff', 'right');
    const isStale = !(text.age < staleAge);
    const age = Number.isNaN(text.age) ? 'no state' : `state age ${Math.round(text.age * 1000)} ms`;
    this.line(age, 164, 28, isStale ? '#ff6b5e' : '#9fb3c8');
    this.line(`scale ${text.scale} : 1`, 164, 28, '#9fb3c8', 'right');
    this.line(text.note, 212, 28, '#ffc14d');
    this.button(0, text.isOnHold ? 'ON HOLD' : 'HOLD', text.isOnHold);
    this.button(1, 'RESET', false);
  }

  private line(text: string, y: number, size: number, colour: string, align = 'left'): void {
    const c = this.sheet.pen;
    c.font = `600 ${size}px system-ui, sans-serif`;
    c.textAlign = align === 'left' ? 'left' : 'right';
    c.fillStyle = colour;
    c.fillText(text, align === 'left' ? 20 : width - 20, y, width - 40);
  }

  private button(index: number, text: string, isLit: boolean): void {
    const c = this.sheet.pen;
    const { x, width: wide } = buttons[index];
    c.fillStyle = isLit ? '#ff8a1f' : '#24425c';
    c.fillRect(x, buttonTop, wide, buttonHeight);
    c.fillStyle = isLit ? '#10161d' : '#ffffff';
    c.font = '700 44px system-ui, sans-serif';
    c.textAlign = 'center';
    c.fillText(text, x + wide / 2, buttonTop + 58, wide - 16);
  }
}
