// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Group, Mesh, MeshBasicMaterial, PlaneGeometry, Vector3 } from 'three';
import { drawnTexture } from '../scene/drawn_texture';
import { type Ball, clearPlace, type Gaze } from './clear_view';
import { faceHead } from './face_head';
import type { Hand, Side } from './hands';

const width = 512;
const rowHeight = 62;
const maxRows = 3;
const size = { width: 0.17, height: (0.17 * maxRows * rowHeight) / width }; // [m]
const below = 0.14; // [m] of the hand: the panel is above it
const stickUse = 0.7; // deflection

/// What a control does, and whether it is used now.
interface Control {
  name: string;
  does: string;
  isUsed: (hand: Hand) => boolean;
}

const clutchControl: Control = {
  name: 'Grip or trigger',
  does: 'hold: the tool follows',
  isUsed: (hand) => hand.isClutchHeld,
};
const controllers: Record<'tool' | 'free', Control[]> = {
  tool: [
    clutchControl,
    { name: 'Lower button', does: 'pause, continue', isUsed: (hand) => hand.isHoldPressed },
    { name: 'Upper button', does: 'change the hands', isUsed: (hand) => hand.isExtraPressed },
  ],
  free: [
    {
      name: 'Stick',
      does: 'forward: go, aside: turn',
      isUsed: ({ stick }) => Math.max(Math.abs(stick.x), -stick.y) > stickUse,
    },
    { name: 'Lower button', does: 'pause, continue', isUsed: (hand) => hand.isHoldPressed },
    { name: 'Upper button', does: 'size of the world', isUsed: (hand) => hand.isExtraPressed },
  ],
};
const trackedHands: Record<'tool' | 'free', Control[]> = {
  tool: [{ ...clutchControl, name: 'Pinch' }],
  free: [{ name: 'Pinch, let go', does: 'go there', isUsed: (hand) => hand.isClutchHeld }],
};

/// A card at each hand that names its controls, each until it was used for the first time.
export class Cards {
  readonly group = new Group();
  private readonly used = new Set<string>();
  private readonly cards: Record<Side, Card> = { left: new Card(), right: new Card() };

  constructor() {
    this.group.add(this.cards.left.mesh, this.cards.right.mesh);
  }

  /// Once a frame; all in the headset's space. `balls`: what the cards may not hide.
  update(hands: readonly Hand[], tool: Side, gaze: Gaze, balls: readonly Ball[]): void {
    for (const side of ['left', 'right'] as const) {
      const hand = hands.find((other) => other.side === side);
      const card = this.cards[side];
      card.mesh.visible = false;
      if (!hand) continue;
      const role = side === tool ? 'tool' : 'free';
      const controls = (hand.isHand ? trackedHands : controllers)[role];
      const key = (control: Control) => `${role} ${control.name}`;
      for (const control of controls) if (control.isUsed(hand)) this.used.add(key(control));
      const unused = controls.filter((control) => !this.used.has(key(control)));
      card.show(unused, hand.position, gaze, balls, side === 'right' ? 1 : -1);
    }
  }

  /// The names of the controls that a hand's card has; empty if it is not shown.
  shown(side: Side): string[] {
    const { mesh, rows } = this.cards[side];
    return mesh.visible ? rows.map(({ name }) => name) : [];
  }
}

class Card {
  readonly mesh: Mesh;
  rows: readonly Control[] = [];
  private readonly sheet = drawnTexture(width, maxRows * rowHeight);

  constructor() {
    this.mesh = new Mesh(
      new PlaneGeometry(size.width, size.height),
      new MeshBasicMaterial({ map: this.sheet.texture, toneMapped: false, transparent: true }),
    );
    this.mesh.name = 'card';
    this.mesh.visible = false;
  }

  show(
    rows: readonly Control[],
    hand: Vector3,
    gaze: Gaze,
    balls: readonly Ball[],
    outward: number,
  ): void {
    this.mesh.visible = rows.length > 0;
    if (rows.length === 0) return;
    if (rows.length !== this.rows.length || rows.some((row, i) => row !== this.rows[i]))
      this.draw(rows);
    const under = hand.clone().add(new Vector3(0, -below, 0));
    this.mesh.position.copy(clearPlace(under, size, gaze, balls, outward));
    faceHead(this.mesh, gaze.head);
  }

  private draw(rows: readonly Control[]): void {
    this.rows = rows;
    const { pen, texture } = this.sheet;
    pen.clearRect(0, 0, width, maxRows * rowHeight);
    pen.fillStyle = '#10161d';
    pen.fillRect(0, 0, width, rows.length * rowHeight);
    pen.textAlign = 'left';
    rows.forEach(({ name, does }, i) => {
      const y = i * rowHeight + 42;
      pen.font = '700 30px system-ui, sans-serif';
      pen.fillStyle = '#ffb454';
      pen.fillText(name, 14, y, 210);
      pen.font = '600 28px system-ui, sans-serif';
      pen.fillStyle = '#ffffff';
      pen.fillText(does, 236, y, width - 248);
    });
    texture.needsUpdate = true;
  }
}
