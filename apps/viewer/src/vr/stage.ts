// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { GridHelper, type Object3D, type PerspectiveCamera } from 'three';

/// Lines on the floor, half a metre apart: a scan seldom shows what one stands on.
export function floorGrid(): GridHelper {
  const grid = new GridHelper(6, 12, 0x5b7083, 0x5b7083);
  grid.rotation.x = Math.PI / 2; // three.js draws it level in its own axes, y up
  grid.material.transparent = true;
  grid.material.opacity = 0.35;
  return grid;
}

/// Hangs a camera on the rig, where the headset leads it; what is given back puts it where it was.
export function lend(camera: PerspectiveCamera, rig: Object3D): () => void {
  const { parent, fov, zoom, aspect } = camera;
  const before = camera.matrix.clone();
  rig.add(camera);
  return () => {
    if (parent) parent.add(camera);
    else camera.removeFromParent();
    Object.assign(camera, { fov, zoom, aspect });
    before.decompose(camera.position, camera.quaternion, camera.scale);
    camera.updateProjectionMatrix();
  };
}
