// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Mesh, MeshBasicMaterial, PlaneGeometry, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';
import { type Ball, clearPlace, type Gaze } from './clear_view';
import { faceHead } from './face_head';
import { type ButtonState, labelOf, type PanelButton, panelButtons } from './panel_buttons';
import { Press } from './press';
import { stopButtonHeight } from './stop_button';
import { timeSlider } from './time_slider';

export type { PanelButton } from './panel_buttons';

/// The content of the panel.
export interface PanelText extends ButtonState {
  object: string; // touched: a body's name, "scan", or empty
  phase: string;
  force: number; // [N]
  age: number; // [s] of the newest state; NaN before the first
  note: string; // the interlock that keeps the clutch open, or empty
  scale: number;
}

const width = 512;
const height = 614;
// The panel's width: 0.3 mm a pixel is readable at arm's length in a headset [m].
const metres = 0.16;
export const panelHeight = (metres * height) / width; // [m]
// The state age from which the number is red: six frames at 60 Hz [s].
const staleAge = 0.1;
// Redraw interval of numbers: faster can't be read, and each redraw uploads a texture [ms].
const redrawMs = 150;
// The buttons, in pixels from the panel's upper left corner: three in a row.
const buttonTop = 232;
const buttonSize = { x: 152, y: 84 };
const buttonStep = { x: 164, y: 94 };
const buttonLeft = 16;
const confirmMs = 3000; // in which a second press confirms a reset

function cornerOf(index: number): { x: number; y: number } {
  const row = Math.floor(index / 3);
  return { x: buttonLeft + (index % 3) * buttonStep.x, y: buttonTop + row * buttonStep.y };
}

/// From pixels to the panel's frame [m].
function toPanel({ x, y }: { x: number; y: number }): Vector3 {
  return new Vector3((x / width - 0.5) * metres, ((height / 2 - y) / width) * metres, 0);
}

// Hysteresis of a fingertip's distance to a button [m].
const pressDistance = 0.012;
const releaseDistance = 0.035;
// With the emergency stop [m].
const wholeSize = { width: metres, height: panelHeight + stopButtonHeight };

/// A small panel at the free hand, with state, force and touch buttons.
export class Panel {
  readonly mesh: Mesh;
  private readonly sheet = drawnTexture(width, height);
  private readonly pressed = new Press();
  private shownText = '';
  private shownNumbers = '';
  private buttonState: ButtonState | null = null; // as drawn
  private drawnAt = 0; // [ms]
  private confirmUntil = 0; // [ms] a reset was pressed once; 0: not

  constructor() {
    this.mesh = new Mesh(
      new PlaneGeometry(metres, (metres * height) / width),
      new MeshBasicMaterial({ map: this.sheet.texture, toneMapped: false }),
    );
    this.mesh.name = 'panel';
  }

  /// Above a hand, facing the head, and beside it where it would hide one of `balls`; all in the
  /// headset's space. `outward`: the hand's side, +1 right, -1 left.
  placeAbove(hand: Vector3, gaze: Gaze, balls: readonly Ball[], outward: number): void {
    const lift = stopButtonHeight / 2; // of the whole's centre above the panel's
    const above = hand.clone().add(new Vector3(0, 0.12 + lift, 0));
    this.mesh.position.copy(clearPlace(above, wholeSize, gaze, balls, outward));
    faceHead(this.mesh, gaze.head);
    this.mesh.translateY(-lift);
    this.mesh.updateMatrix();
  }

  /// A button's centre in the panel's frame [m].
  centerOf(button: PanelButton): Vector3 {
    const { x, y } = cornerOf(panelButtons.indexOf(button));
    return toPanel({ x: x + buttonSize.x / 2, y: y + buttonSize.y / 2 });
  }

  /// Redraws what has changed: text at once, numbers at a readable rate. `now` in milliseconds.
  show(text: PanelText, now: number): void {
    if (now > this.confirmUntil) this.confirmUntil = 0;
    const isAsking = this.confirmUntil > 0;
    const labels = panelButtons.map((name) => labelOf(name, text, isAsking));
    const withoutNumbers = JSON.stringify([text.object, text.phase, text.note, text.scale, labels]);
    const time = text.playback?.time.toFixed(2) ?? '';
    const numbers = `${text.force.toFixed(1)} ${Math.round(text.age * 100)} ${time}`;
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

  /// The time [s] of a replay that a fingertip (headset frame) points at on the bar.
  timeAt(tip: Vector3 | undefined, duration: number): number | undefined {
    const at = tip && this.pixelAt(tip, releaseDistance);
    return at && timeSlider.timeAt(at.x, at.y, duration);
  }

  /// Where the bar has a time, in the panel's frame [m].
  placeOf(time: number, duration: number): Vector3 {
    return toPanel(timeSlider.placeOf(time, duration));
  }

  /// A reset by mistake ends the push: true once it was pressed twice. `now` in milliseconds.
  confirmsReset(now: number): boolean {
    const isConfirmed = this.confirmUntil > 0 && now <= this.confirmUntil;
    this.confirmUntil = isConfirmed ? 0 : now + confirmMs;
    return isConfirmed;
  }

  private pixelAt(tip: Vector3, distance: number): { x: number; y: number } | undefined {
    const local = tip.clone().applyMatrix4(this.mesh.matrix.clone().invert());
    if (Math.abs(local.z) > distance) return undefined;
    return {
      x: (local.x / metres + 0.5) * width,
      y: height / 2 - (local.y / metres) * width,
    };
  }

  private buttonAt(tip: Vector3, distance: number): PanelButton | undefined {
    const at = this.pixelAt(tip, distance);
    if (!at) return undefined;
    return panelButtons.find((button, i) => {
      if (this.buttonState && labelOf(button, this.buttonState, false).text === '') return false;
      const corner = cornerOf(i);
      const [dx, dy] = [at.x - corner.x, at.y - corner.y];
      return dx > 0 && dx < buttonSize.x && dy > 0 && dy < buttonSize.y;
    });
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
    if (text.playback) {
      const { time, duration } = text.playback;
      this.line(`${time.toFixed(2)} of ${duration.toFixed(2)} s`, 164, 28, '#9fb3c8');
      timeSlider.draw(c, text.playback);
    } else {
      const isStale = !(text.age < staleAge);
      const age = `state age ${Math.round(text.age * 1000)} ms`;
      const known = Number.isNaN(text.age) ? 'no state' : age;
      this.line(known, 164, 28, isStale ? '#ff6b5e' : '#9fb3c8');
      this.line(text.note, 212, 28, '#ffc14d');
    }
    this.line(`scale ${text.scale} : 1`, 164, 28, '#9fb3c8', 'right');
    panelButtons.forEach((name, i) => {
      const label = labelOf(name, text, this.confirmUntil > 0);
      if (label.text !== '') this.button(i, label.text, label.isLit);
    });
    this.buttonState = text;
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
    const { x, y } = cornerOf(index);
    c.fillStyle = isLit ? '#ff8a1f' : '#24425c';
    c.fillRect(x, y, buttonSize.x, buttonSize.y);
    c.fillStyle = isLit ? '#10161d' : '#ffffff';
    c.font = '700 32px system-ui, sans-serif';
    c.textAlign = 'center';
    c.fillText(text, x + buttonSize.x / 2, y + 54, buttonSize.x - 12);
  }
}
