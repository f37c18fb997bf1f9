// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Sphere, Vector3, type Box3 } from 'three';
import type { Body } from '../scene/bodies';
import type { Ball } from './clear_view';
import type { Person } from './person';

/// How large the bodies are, and where, in the headset's space.
export class BodySizes {
  constructor(private readonly person: Person) {}

  /// The ball around a body.
  ball(body: Body): Ball {
    const { center, radius } = this.boxOf(body).getBoundingSphere(new Sphere());
    const inBase = center.applyQuaternion(body.solid.quaternion).add(body.solid.position);
    return {
      center: this.person.toHeadset(inBase),
      radius: Math.max(0, radius) * this.person.scale,
    };
  }

  /// The point above a body's centre, at the height of its highest corner.
  top(body: Body): Vector3 {
    const { position, quaternion } = body.solid;
    const box = this.boxOf(body);
    const inBase = box.getCenter(new Vector3()).applyQuaternion(quaternion).add(position);
    const corner = new Vector3();
    for (let i = 0; i < 8; ++i) {
      corner.set(
        (i & 1 ? box.max : box.min).x,
        (i & 2 ? box.max : box.min).y,
        (i & 4 ? box.max : box.min).z,
      );
      inBase.z = Math.max(inBase.z, corner.applyQuaternion(quaternion).add(position).z);
    }
    return this.person.toHeadset(inBase);
  }

  /// A point until the mesh is loaded.
  private boxOf({ box }: Body): Box3 {
    return box.isEmpty() ? box.set(new Vector3(), new Vector3()) : box;
  }
}
