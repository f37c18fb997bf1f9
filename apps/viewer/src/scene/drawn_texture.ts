// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { CanvasTexture, SRGBColorSpace } from 'three';

/// A picture to be drawn by `pen`, in the page's colours; `needsUpdate` after each time but the first.
export function drawnTexture(width: number, height: number) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext('2d');
  if (pen === null) throw new Error('This browser draws no pictures: its 2D canvas is off.');
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return { pen, texture };
}
