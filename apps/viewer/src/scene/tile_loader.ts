// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Group, Loader } from 'three';
import { readGlb } from './glb';
import { scanMesh } from './scan_mesh';

/// What 3d-tiles-renderer gets in place of three's loader of the same name (vite.config.ts): the page's own reader of
/// glTF, a fraction of its size, and the scan's materials.
export class GLTFLoader extends Loader {
  async parseAsync(file: ArrayBuffer): Promise<{ scene: Group }> {
    const scene = new Group();
    for (const part of await readGlb(file)) scene.add(scanMesh(part, null));
    return { scene };
  }
}
