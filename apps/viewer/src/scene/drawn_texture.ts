// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { CanvasTexture, SRGBColorSpace } from 'three';

/// A texture drawn by the 2D context `pen` in sRGB; set `needsUpdate` after each redraw.
export function drawnTexture(width: number, height: number) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext('2d');
  if (pen === null) throw new Error('The 2D canvas is not available: allow it for this page.');
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return { pen, texture };
}
