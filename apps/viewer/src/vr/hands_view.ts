// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  CapsuleGeometry,
  Group,
  InstancedMesh,
  LineBasicMaterial,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  SphereGeometry,
} from 'three';
import type { Vector } from '../protocol';
import { Segment } from '../scene/segment';
import type { Hand, Side } from './hands';

const maxJoints = 25; // of an XRHand
const toolColour = 0xffb454;
const freeColour = 0x7fb6d9;

/// One hand: a handle where a controller is, its joints where it is bare.
class HandView {
  readonly group = new Group();
  private readonly material = new MeshStandardMaterial({ roughness: 0.6 });
  private readonly handle = new Group();
  private readonly joints = new InstancedMesh(
    new SphereGeometry(0.007, 10, 8),
    this.material,
    maxJoints,
  );

  constructor() {
    // A rod held in the fist lies along the grip's z axis.
    const stick = new Mesh(
      new CapsuleGeometry(0.013, 0.09, 4, 12).rotateX(Math.PI / 2),
      this.material,
    );
    const tip = new Mesh(new SphereGeometry(0.008, 16, 12), this.material);
    this.handle.add(stick, tip);
    this.joints.frustumCulled = false;
    this.group.add(this.handle, this.joints);
    this.group.visible = false;
  }

  show(hand: Hand | undefined, isTool: boolean): void {
    this.group.visible = hand !== undefined;
    if (hand === undefined) return;
    this.material.color.setHex(isTool ? toolColour : freeColour);
    this.handle.visible = !hand.isHand;
    this.handle.position.copy(hand.place);
    this.handle.quaternion.copy(hand.rotation);
    this.joints.count = Math.min(hand.joints.length, maxJoints);
    const at = new Matrix4();
    for (let i = 0; i < this.joints.count; ++i) {
      this.joints.setMatrixAt(i, at.setPosition(hand.joints[i]));
    }
    this.joints.instanceMatrix.needsUpdate = true;
  }
}

/// Both hands (headset), and the thread from the hand that holds the tool to the tool (base).
export class HandsView {
  readonly group = new Group(); // hangs on the person's rig
  /// Hangs in base.
  readonly thread = new Segment(new LineBasicMaterial({ color: toolColour }));
  private readonly views: Record<Side, HandView> = { left: new HandView(), right: new HandView() };

  constructor() {
    this.group.add(this.views.left.group, this.views.right.group);
    this.thread.visible = false;
  }

  show(hands: Hand[], tool: Side): void {
    for (const side of ['left', 'right'] as const) {
      this.views[side].show(
        hands.find((h) => h.side === side),
        side === tool,
      );
    }
  }

  /// From the hand to what it leads; both in base. Hidden without one of them.
  showThread(hand: Vector | undefined, tool: Vector | undefined): void {
    this.thread.visible = hand !== undefined && tool !== undefined;
    if (hand && tool) this.thread.join(hand, tool);
  }
}
