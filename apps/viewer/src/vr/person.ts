// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Group, Matrix4, Quaternion, Vector3 } from 'three';

/// The scales at which the world may be shown.
export const worldScales = [0.5, 1, 2, 4] as const;

/// The pose and scale of the XR rig: where the user stands, and how large the world appears.
///
/// The headset's space has y up, -z forward, unscaled metres, the floor at y = 0. `rig` maps it to
/// base (z up). The rig's children (camera, hands, panel) are given in the headset's space and keep
/// their apparent size when the world's scale changes.
export class Person {
  readonly rig = new Group();
  private heading = 0; // [rad] of the forward direction, about z, from x
  private worldScale = 1;

  get scale(): number {
    return this.worldScale;
  }

  /// Stands with the head's plan position above `foot` (base), looking along `heading` [rad].
  standAt(foot: Vector3, heading: number, head: Vector3): void {
    this.heading = heading;
    this.rotateRig();
    this.align(new Vector3(head.x, 0, head.z), foot);
  }

  /// Moves horizontally to `point` (base); the height over the scene is kept.
  goTo(point: Vector3, head: Vector3): void {
    const under = new Vector3(head.x, 0, head.z);
    const height = this.toBase(under).z;
    this.align(under, new Vector3(point.x, point.y, height));
  }

  /// Brings a point of the scene (base) to a place in the headset's space; the heading is kept.
  bring(point: Vector3, place: Vector3): void {
    this.align(place, point);
  }

  /// Rotates about the head, by `angle` [rad] to the left.
  turnBy(angle: number, head: Vector3): void {
    const before = this.toBase(head);
    this.heading += angle;
    this.rotateRig();
    this.align(head, before);
  }

  /// Scales the world by `scale` with the fixed point `pivot` (headset).
  scaleTo(scale: number, pivot: Vector3): void {
    const before = this.toBase(pivot);
    this.worldScale = scale;
    this.rig.scale.setScalar(1 / scale);
    this.align(pivot, before);
  }

  /// A point from the headset's space to base.
  toBase(point: Vector3): Vector3 {
    return point.clone().applyMatrix4(this.rig.matrix);
  }

  /// A point from base to the headset's space.
  toHeadset(point: Vector3): Vector3 {
    return point.clone().applyMatrix4(this.rig.matrix.clone().invert());
  }

  /// A rotation from the headset's space to base.
  rotationToBase(rotation: Quaternion): Quaternion {
    return this.rig.quaternion.clone().multiply(rotation);
  }

  private rotateRig(): void {
    const c = Math.cos(this.heading);
    const s = Math.sin(this.heading);
    const axes = new Matrix4().makeBasis(
      new Vector3(s, -c, 0),
      new Vector3(0, 0, 1),
      new Vector3(-c, -s, 0),
    );
    this.rig.quaternion.setFromRotationMatrix(axes);
  }

  /// Translates the rig so that `point` (headset) is at `target` (base).
  private align(point: Vector3, target: Vector3): void {
    this.rig.position.set(0, 0, 0);
    this.rig.updateMatrix();
    this.rig.position.copy(target).sub(this.toBase(point));
    this.rig.updateMatrix();
    this.rig.updateMatrixWorld(true);
  }
}
