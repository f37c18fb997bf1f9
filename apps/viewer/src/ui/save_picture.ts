// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from '../app';
import { create } from './dom';

/// Saves what the view shows as NAME.png.
export function savePicture(app: App, name: string): void {
  // The picture is kept only until the browser has shown it: drawn once more.
  app.renderer.render(app.scene, app.camera);
  app.canvas.toBlob((picture) => {
    if (!picture) return app.notify({ level: 'error', text: 'The browser gave no picture.' });
    const url = URL.createObjectURL(picture);
    create('a', { href: url, download: `${name || 'scene'}.png` }).click();
    setTimeout(() => URL.revokeObjectURL(url));
  });
}
