// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { LinearMipmapLinearFilter, SRGBColorSpace, Texture } from 'three';
import { fetchBytes } from './scene_model';

const anisotropy = 4; // a table is seen at a flat angle

/// Fetches a scan's or a body's texture and decodes it off the main thread. Throws an Error like fetchBytes.
export async function fetchTexture(
  url: string,
  onProgress: (bytes: number) => void,
): Promise<Texture> {
  const image = await createImageBitmap(new Blob([await fetchBytes(url, onProgress)]));
  const texture = new Texture(image);
  texture.flipY = false; // glTF's origin is the upper left corner
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = anisotropy;
  texture.needsUpdate = true;
  return texture;
}
