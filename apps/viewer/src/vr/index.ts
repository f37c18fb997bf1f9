// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3 } from 'three';
import type { App } from '../app';
import { heightOf } from '../scene/outline';
import { passthroughButton, vrButton } from './button';
import type { Ground } from './start';
import { VrMode } from './vr_mode';

/// Adds the VR button and mode to the page.
export function attachVr(app: App): void {
  const vr = new VrMode(app, () => groundOf(app));
  const onError = (text: string) => app.notify({ level: 'error', text });
  app.actions.append(vrButton(vr, onError), passthroughButton(vr, onError));
  app.onFrame((time, _, frame) => {
    if (frame && vr.isPresenting) vr.update(time, frame);
  });
  if (window.__pcavr) window.__pcavr.vr = vr;
}

/// The surfaces and objects that determine where the user stands.
function groundOf(app: App): Ground {
  const { model, bodies, layers, base } = app.view;
  const supports = (model?.support_planes ?? []).map(({ outline }) => ({
    z: heightOf(outline),
    outline,
  }));
  const scan = new Box3().setFromObject(layers.group('mesh'));
  // The box is in three.js coordinates, y up; heights in base count from its origin.
  const scanMinZ = scan.isEmpty() ? undefined : scan.min.y - base.position.y;
  const objects = bodies.filter((b) => b.object.movable).map((b) => b.solid.position.clone());
  const cameras = (model?.cameras ?? []).map(({ position }) => position);
  return { supports, scanMinZ, objects, cameras };
}
