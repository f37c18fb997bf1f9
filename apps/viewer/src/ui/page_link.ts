// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { Navigation } from '../input/navigation';
import type { Vector } from '../protocol';
import type { Timeline } from '../replay/timeline';
import { layerNames, type LayerName } from '../scene/layers';
import type { SceneView } from '../scene/view';
import { decodeLink, encodeLink } from './link_state';

const intervalMs = 500; // browsers limit how often an address may change

/// Keeps view, layers and a paused replay's time in the page's address, so that a copied link shows
/// the same.
export class PageLink {
  private lastTime = -Infinity; // [ms]
  private written = '';
  private readonly shownAtFirst: string;

  constructor(
    private readonly view: SceneView,
    private readonly navigation: Navigation,
    private readonly timeline: () => Timeline | null,
  ) {
    this.shownAtFirst = this.shownLayers().join();
  }

  /// Shows what the address says; to be called when the layers are there.
  restoreLayers(): void {
    const { layers } = decodeLink(location.hash);
    if (!layers) return;
    for (const name of layerNames) this.view.layers.show(name, layers.includes(name));
  }

  /// To be called when the scene is loaded. The time of a replay, if the address has one.
  restoreView(): number | undefined {
    const { eye, target, time } = decodeLink(location.hash);
    if (eye && target) this.navigation.place(this.toScene(eye), this.toScene(target));
    return time;
  }

  /// To be called each frame, `time` in ms.
  update(time: number): void {
    if (time - this.lastTime < intervalMs) return;
    this.lastTime = time;
    const hash = this.current();
    if (hash === this.written) return;
    this.written = hash;
    history.replaceState(
      history.state,
      '',
      hash === '' ? location.pathname + location.search : `#${hash}`,
    );
  }

  private current(): string {
    const { navigation, view } = this;
    const layers = this.shownLayers();
    const timeline = this.timeline();
    return encodeLink({
      ...(navigation.hasMoved && {
        eye: this.toBase(view.camera.position),
        target: this.toBase(navigation.controls.target),
      }),
      ...(layers.join() !== this.shownAtFirst && { layers }),
      ...(timeline && !timeline.isPlaying && timeline.time > 0 && { time: timeline.time }),
    });
  }

  private shownLayers(): LayerName[] {
    return layerNames.filter((name) => this.view.layers.isShown(name));
  }

  private toScene(point: Vector): Vector3 {
    return this.view.base.localToWorld(new Vector3(...point));
  }

  private toBase(point: Vector3): Vector {
    return this.view.base.worldToLocal(point.clone()).toArray();
  }
}
