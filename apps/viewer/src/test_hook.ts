// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from './app';
import type { ReplayPlayer } from './replay/replay';
import type { SceneLoader } from './scene/loading';

declare global {
  interface Window {
    /// What tests of the page look at, instead of at pixels.
    __pcavr?: TestHook;
  }
}

export class TestHook {
  firstPicture = NaN; // [ms] from the start of the page to the first picture with something in it
  replay: ReplayPlayer | null = null;
  vr: unknown = null; // src/vr puts here what its tests look at

  constructor(
    readonly app: App,
    private readonly loader: SceneLoader,
  ) {}

  get state() {
    return this.app.session.latest();
  }

  get connection() {
    return this.app.session.connection;
  }

  /// States that were never taken in.
  get skipped() {
    return this.app.session.skipped;
  }

  get latency() {
    return this.app.session.figures();
  }

  get layers() {
    return this.app.view.layers.all();
  }

  get timeline() {
    return this.replay?.timeline ?? null;
  }

  get scene() {
    const { level, objectsLoaded, isComplete, failures } = this.loader;
    const { firstPicture } = this;
    return { level, objectsLoaded, isComplete, failures, firstPicture };
  }

  /// Where the bodies are drawn, in base.
  get bodies() {
    return this.app.view.bodies.map((body) => ({
      name: body.object.name,
      phase: body.phase,
      isOutsideModel: body.isOutsideModel,
      position: body.solid.position.toArray(),
      quaternion: body.solid.quaternion.toArray(),
      ghost: body.ghost.visible ? body.ghost.position.toArray() : null,
    }));
  }

  /// All of it that is plain data.
  summary() {
    const { skipped, latency, scene, bodies } = this;
    return { skipped, latency, scene, bodies };
  }
}
