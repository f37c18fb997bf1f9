// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { GridHelper, type Object3D, type PerspectiveCamera } from 'three';

/// A floor grid with 0.5 m spacing: scans seldom contain the floor.
export function makeFloorGrid(): GridHelper {
  const grid = new GridHelper(6, 12, 0x5b7083, 0x5b7083);
  grid.rotation.x = Math.PI / 2; // from three.js's horizontal plane, y up, to z up
  grid.material.transparent = true;
  grid.material.opacity = 0.35;
  return grid;
}

/// Makes a camera a child of the rig, driven by the headset; the returned function restores it.
export function attachCamera(camera: PerspectiveCamera, rig: Object3D): () => void {
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
