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

/// One hand: a rod for a controller, spheres at the joints of a tracked hand.
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
    // The grip's z axis is the axis of a rod held in the fist.
    const rod = new Mesh(
      new CapsuleGeometry(0.013, 0.09, 4, 12).rotateX(Math.PI / 2),
      this.material,
    );
    const tip = new Mesh(new SphereGeometry(0.008, 16, 12), this.material);
    this.handle.add(rod, tip);
    this.joints.frustumCulled = false;
    this.group.add(this.handle, this.joints);
    this.group.visible = false;
  }

  show(hand: Hand | undefined, isTool: boolean): void {
    this.group.visible = hand !== undefined;
    if (hand === undefined) return;
    this.material.color.setHex(isTool ? toolColour : freeColour);
    this.handle.visible = !hand.isHand;
    this.handle.position.copy(hand.position);
    this.handle.quaternion.copy(hand.rotation);
    this.joints.count = Math.min(hand.joints.length, maxJoints);
    const at = new Matrix4();
    for (let i = 0; i < this.joints.count; ++i) {
      this.joints.setMatrixAt(i, at.setPosition(hand.joints[i]));
    }
    this.joints.instanceMatrix.needsUpdate = true;
  }
}

/// Both hands (headset frame), and a line that shows the offset from hand to tool (base).
export class HandsView {
  readonly group = new Group(); // child of the user's rig
  /// Child of base.
  readonly offsetLine = new Segment(new LineBasicMaterial({ color: toolColour }));
  private readonly views: Record<Side, HandView> = { left: new HandView(), right: new HandView() };

  constructor() {
    this.group.add(this.views.left.group, this.views.right.group);
    this.offsetLine.visible = false;
  }

  show(hands: Hand[], tool: Side): void {
    for (const side of ['left', 'right'] as const) {
      this.views[side].show(
        hands.find((h) => h.side === side),
        side === tool,
      );
    }
  }

  /// From the hand to the tool, both in base; hidden without one of them.
  showOffsetLine(hand: Vector | undefined, tool: Vector | undefined): void {
    this.offsetLine.visible = hand !== undefined && tool !== undefined;
    if (hand && tool) this.offsetLine.join(hand, tool);
  }
}
