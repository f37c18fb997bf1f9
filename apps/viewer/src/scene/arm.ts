// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Quaternion,
  Vector3,
} from 'three';
import type { Quaternion as QuaternionNumbers, Vector } from '../protocol';
import type { GlbPart } from './glb';
import { seeThrough } from './see_through';

const edgeAngle = 25; // [degrees] between faces, as of the CAD bodies

interface PlacedFrame {
  position: Vector;
  quaternion: QuaternionNumbers;
}

export interface ArmJoint extends PlacedFrame {
  name: string;
  parent: number | null; // index of the joint that carries it; null: the arm's base
  axis: Vector;
  slides: boolean; // prismatic
  coordinate: number; // index of its position in a state
  multiplier: number; // its own position is multiplier * position + offset
  offset: number;
}

export interface ArmLink extends PlacedFrame {
  name: string;
  joint: number | null; // that carries it; null: the arm's base
  path: string | null; // of its mesh
  bytes: number;
}

/// The arm of `/api/scene.json`: its tree of joints, parents first, at the pose of its base.
export interface ArmModel extends PlacedFrame {
  name: string;
  tip: string;
  start: number[];
  joints: ArmJoint[];
  links: ArmLink[];
}

const armColor = '#d9dde2';
const stoppedColor = '#d9480f';

/// An arm, drawn by forward kinematics from its joints' positions.
export class ArmView {
  readonly group = new Group();
  position: readonly number[]; // of the joints [rad or m]
  isStopped = false;
  private joints: Group[] = [];
  private links: Group[] = [];
  private rest: { position: Vector3; quaternion: Quaternion; axis: Vector3 }[] = [];
  private fill = seeThrough(new MeshLambertMaterial({ color: armColor }));
  private edges = new LineBasicMaterial({ color: '#5c6670' });

  constructor(readonly model: ArmModel) {
    this.group.name = model.name;
    place(this.group, model);
    for (const joint of model.joints) {
      const group = new Group();
      group.name = joint.name;
      place(group, joint);
      this.rest.push({
        position: group.position.clone(),
        quaternion: group.quaternion.clone(),
        axis: new Vector3(...joint.axis),
      });
      (joint.parent === null ? this.group : this.joints[joint.parent]).add(group);
      this.joints.push(group);
    }
    for (const link of model.links) {
      const group = new Group();
      group.name = link.name;
      place(group, link);
      (link.joint === null ? this.group : this.joints[link.joint]).add(group);
      this.links.push(group);
    }
    this.position = model.start;
    this.show(model.start);
  }

  addParts(link: number, parts: readonly GlbPart[]): void {
    for (const { geometry, matrix } of parts)
      for (const child of [
        new Mesh(geometry, this.fill),
        new LineSegments(new EdgesGeometry(geometry, edgeAngle), this.edges),
      ]) {
        child.matrixAutoUpdate = false;
        child.matrix.copy(matrix);
        this.links[link].add(child);
      }
  }

  show(position: readonly number[]): void {
    this.position = position;
    this.model.joints.forEach((joint, i) => {
      const { position: at, quaternion, axis } = this.rest[i];
      const own = joint.multiplier * (position[joint.coordinate] ?? 0) + joint.offset;
      const group = this.joints[i];
      if (joint.slides)
        group.position.copy(axis).multiplyScalar(own).applyQuaternion(quaternion).add(at);
      else group.quaternion.setFromAxisAngle(axis, own).premultiply(quaternion);
    });
  }

  setStopped(isStopped: boolean): void {
    if (isStopped === this.isStopped) return;
    this.isStopped = isStopped;
    this.fill.color.set(isStopped ? stoppedColor : armColor);
  }

  /// The links' poses as drawn, in base; for tests.
  linkPoses(base: Group): { name: string; position: Vector; quaternion: number[] }[] {
    base.updateMatrixWorld(true);
    const toBase = base.matrixWorld.clone().invert();
    return this.links.map((link) => {
      const [position, quaternion, scale] = [new Vector3(), new Quaternion(), new Vector3()];
      toBase.clone().multiply(link.matrixWorld).decompose(position, quaternion, scale);
      return { name: link.name, position: position.toArray(), quaternion: quaternion.toArray() };
    });
  }
}

function place(group: Group, { position, quaternion }: PlacedFrame): void {
  group.position.fromArray(position);
  group.quaternion.fromArray(quaternion);
}
