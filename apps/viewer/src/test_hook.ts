// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from './app';
import type { ReplayPlayer } from './replay/replay';
import type { SceneLoader } from './scene/loading';
import type { TileStream } from './scene/tile_stream';

declare global {
  interface Window {
    /// State that browser tests read instead of pixels.
    __pcavr?: TestHook;
  }
}

export class TestHook {
  firstFrameTime = NaN; // [ms] from the start of the page to the first frame with content
  replay: ReplayPlayer | null = null;
  tiles: TileStream | null = null; // of a tiled scan
  vr: unknown = null; // the VrMode, set by src/vr

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

  /// States that were replaced by newer ones before the page read them.
  get skipped() {
    return this.app.session.skipped;
  }

  get latency() {
    return this.app.session.latencyStats();
  }

  get layers() {
    return this.app.view.layers.all();
  }

  get timeline() {
    return this.replay?.timeline ?? null;
  }

  get scene() {
    const { level, objectsLoaded, isComplete, failures } = this.loader;
    const { firstFrameTime } = this;
    return { level, objectsLoaded, isComplete, failures, firstFrameTime };
  }

  /// The poses at which the bodies are drawn, in base.
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

  /// The poses at which the arm's links are drawn, in base, and its joints' positions.
  get arm() {
    const { arm, base } = this.app.view;
    if (!arm) return null;
    const { position, isStopped } = arm;
    return { position: [...position], isStopped, links: arm.linkPoses(base) };
  }

  /// The plain data of this hook.
  summary() {
    const { skipped, latency, scene, bodies } = this;
    return { skipped, latency, scene, bodies };
  }
}
