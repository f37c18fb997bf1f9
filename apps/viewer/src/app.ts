// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { WebGLRenderer, type Group, type PerspectiveCamera, type Scene } from 'three';
import { SceneView } from './scene/view';
import { pageClock } from './session/clock';
import type { Playback } from './replay/playback';
import type { Session } from './session/session';
import type { LiveState, Notice } from './protocol';
import { looksDifferent } from './session/state_change';

/// A frame's time [ms], the seconds since the previous frame, and in VR its XRFrame.
type FrameCallback = (time: number, seconds: number, frame?: XRFrame) => void;

const maxPixelRatio = 2; // above, no visible gain at four times the GPU load
const staleSeconds = 0.04; // two to three states: an older state is not worth drawing
const maxSkippedFrames = 3; // frames skipped in a row, then the newest state there is gets drawn

/// The render loop: runs the frame callbacks, and renders only when something changed.
export class App {
  readonly renderer: WebGLRenderer;
  readonly view = new SceneView();
  readonly scene: Scene = this.view.scene;
  readonly camera: PerspectiveCamera = this.view.camera;
  readonly base: Group = this.view.base;
  readonly isSoftwareRendered: boolean;
  showsLiveState = true; // false: a replay places bodies and tool
  playback: Playback | null = null; // of a replay, once it is loaded
  private callbacks: FrameCallback[] = [];
  private drawnCallbacks: (() => void)[] = [];
  private blindCallbacks: ((isBlind: boolean) => void)[] = [];
  private isDirty = true;
  private lastFrame = NaN; // [ms]
  private isBlind = false;
  private lastShown: LiveState | null = null;
  private skippedFrames = 0; // since the last one that was not skipped

  constructor(
    readonly canvas: HTMLCanvasElement,
    readonly session: Session,
    /// Where buttons such as "Enter VR" go.
    readonly actions: HTMLElement,
    readonly notify: (notice: Notice) => void,
  ) {
    const graphics = graphicsName();
    if (graphics === '')
      throw new Error('WebGL 2 is not available: enable it or use another browser.');
    this.isSoftwareRendered = /llvmpipe|swiftshader|software/i.test(graphics);
    // Antialiasing is too slow on a software renderer.
    const antialias = !this.isSoftwareRendered;
    this.renderer = new WebGLRenderer({ canvas, antialias, powerPreference: 'high-performance' });
    const ratio = Math.min(window.devicePixelRatio, maxPixelRatio);
    this.renderer.setPixelRatio(this.isSoftwareRendered ? 1 : ratio);
    this.renderer.xr.enabled = true;
    canvas.addEventListener('webglcontextlost', () => this.setBlind(true));
    canvas.addEventListener('webglcontextrestored', () => this.setBlind(false));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  start(): void {
    this.renderer.setAnimationLoop((time, frame) => this.frame(time, frame));
  }

  /// Called before each frame.
  onFrame(callback: FrameCallback): void {
    this.callbacks.push(callback);
  }

  onDrawn(callback: () => void): void {
    this.drawnCallbacks.push(callback);
  }

  /// Called when the browser has taken the graphics context away, so that nothing can be drawn, and
  /// when it has given it back.
  onBlind(callback: (isBlind: boolean) => void): void {
    this.blindCallbacks.push(callback);
  }

  /// Requests a redraw in the next frame.
  invalidate(): void {
    this.isDirty = true;
  }

  private frame(time: number, frame?: XRFrame): void {
    const isInVr = this.renderer.xr.isPresenting;
    if (!isInVr && this.shouldSkipFrame()) return;
    const state = this.session.latest();
    if (!state) this.lastShown = null; // a lost state is drawn again, even if it is the same
    if (state && this.showsLiveState && this.needsRedraw(state)) {
      this.lastShown = state;
      this.view.showState(state);
      this.isDirty = true;
    }
    const seconds = Number.isFinite(this.lastFrame) ? (time - this.lastFrame) / 1000 : 0;
    this.lastFrame = time;
    for (const callback of this.callbacks) callback(time, seconds, frame);
    if (this.isBlind || (!this.isDirty && !isInVr)) return;
    this.isDirty = false;
    this.renderer.render(this.scene, this.camera);
    this.session.recordDrawn();
    for (const callback of this.drawnCallbacks) callback();
  }

  /// A scene at rest is not redrawn; while the tool is engaged, every new state is drawn.
  private needsRedraw(state: LiveState): boolean {
    if (state === this.lastShown) return false;
    return !this.lastShown || state.isEngaged || looksDifferent(this.lastShown, state);
  }

  /// A busy browser schedules frames before messages: skipped frames let the newest state arrive.
  private shouldSkipFrame(): boolean {
    const isStale =
      this.session.latest() !== null && this.session.latency.lag(pageClock()) > staleSeconds;
    this.skippedFrames =
      isStale && this.skippedFrames < maxSkippedFrames ? this.skippedFrames + 1 : 0;
    return this.skippedFrames > 0;
  }

  private setBlind(isBlind: boolean): void {
    this.isBlind = isBlind;
    this.isDirty = true;
    for (const callback of this.blindCallbacks) callback(isBlind);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    if (this.renderer.xr.isPresenting || clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.isDirty = true;
  }
}

/// The name of the GPU or software renderer; empty without WebGL 2.
function graphicsName(): string {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = gl ? String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return name;
}
