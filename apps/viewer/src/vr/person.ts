// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Group, Matrix4, Quaternion, Vector3 } from 'three';

/// How many times larger than life the world may be shown.
export const worldScales = [0.5, 1, 2, 4] as const;

/// Where the person stands, and how large the world looks to them.
///
/// The headset measures in its own space: y up, -z straight ahead, metres of the person, the floor at
/// y = 0. `rig` maps that space to base: z up. What hangs on the rig (camera, hands, panel) is given in
/// the headset's space and keeps its size when the world's scale changes.
export class Person {
  readonly rig = new Group();
  private heading = 0; // [rad] of straight ahead, about z, from x
  private worldScale = 1;

  get scale(): number {
    return this.worldScale;
  }

  /// Stands with the head's plan position above `foot` (base), looking along `heading` [rad].
  standAt(foot: Vector3, heading: number, head: Vector3): void {
    this.heading = heading;
    this.turnRig();
    this.keep(new Vector3(head.x, 0, head.z), foot);
  }

  /// Goes to above `place` (base); the height over the scene stays what it was.
  goTo(place: Vector3, head: Vector3): void {
    const under = new Vector3(head.x, 0, head.z);
    const height = this.toBase(under).z;
    this.keep(under, new Vector3(place.x, place.y, height));
  }

  /// Turns about the head, by `angle` [rad] to the left.
  turnBy(angle: number, head: Vector3): void {
    const there = this.toBase(head);
    this.heading += angle;
    this.turnRig();
    this.keep(head, there);
  }

  /// Shows the world `scale` times larger than life; what is at `pivot` (headset) stays there.
  scaleTo(scale: number, pivot: Vector3): void {
    const there = this.toBase(pivot);
    this.worldScale = scale;
    this.rig.scale.setScalar(1 / scale);
    this.keep(pivot, there);
  }

  /// A point from the headset's space to base.
  toBase(point: Vector3): Vector3 {
    return point.clone().applyMatrix4(this.rig.matrix);
  }

  /// A rotation from the headset's space to base.
  rotationToBase(rotation: Quaternion): Quaternion {
    return this.rig.quaternion.clone().multiply(rotation);
  }

  private turnRig(): void {
    const c = Math.cos(this.heading);
    const s = Math.sin(this.heading);
    const axes = new Matrix4().makeBasis(
      new Vector3(s, -c, 0),
      new Vector3(0, 0, 1),
      new Vector3(-c, -s, 0),
    );
    this.rig.quaternion.setFromRotationMatrix(axes);
  }

  /// Moves the rig so that `point` (headset) is at `place` (base).
  private keep(point: Vector3, place: Vector3): void {
    this.rig.position.set(0, 0, 0);
    this.rig.updateMatrix();
    this.rig.position.copy(place).sub(this.toBase(point));
    this.rig.updateMatrix();
    this.rig.updateMatrixWorld(true);
  }
}
