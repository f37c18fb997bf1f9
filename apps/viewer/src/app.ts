// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { WebGLRenderer, type Group, type PerspectiveCamera, type Scene } from 'three';
import { SceneView } from './scene/view';
import { pageClock } from './session/clock';
import type { Session } from './session/session';
import type { LiveState, Notice } from './protocol';
import { looksDifferent } from './session/state_change';

/// A frame's time [ms], the seconds since the one before, and in VR its XRFrame.
type FrameCallback = (time: number, seconds: number, frame?: XRFrame) => void;

const maxPixelRatio = 2; // beyond, an eye sees no more and a graphics card does four times the work
const staleSeconds = 0.04; // two to three states: a picture of one so late is not worth drawing
const maxWaits = 3; // frames given up in a row: if then nothing newer has come, nothing has

/// One picture after the other: asks everybody before each, and draws only where something changed.
export class App {
  readonly renderer: WebGLRenderer;
  readonly view = new SceneView();
  readonly scene: Scene = this.view.scene;
  readonly camera: PerspectiveCamera = this.view.camera;
  readonly base: Group = this.view.base;
  readonly isSoftwareRendered: boolean;
  followsWorld = true; // false: something else, such as a replay, places bodies and tool
  private callbacks: FrameCallback[] = [];
  private drawnCallbacks: (() => void)[] = [];
  private isDirty = true;
  private lastFrame = NaN; // [ms]
  private lastShown: LiveState | null = null;
  private waits = 0; // frames given up since the last one

  constructor(
    readonly canvas: HTMLCanvasElement,
    readonly session: Session,
    /// Where buttons such as "Enter VR" go.
    readonly actions: HTMLElement,
    readonly notify: (notice: Notice) => void,
  ) {
    const graphics = graphicsName();
    if (graphics === '')
      throw new Error('This browser draws nothing in 3D: WebGL 2 is missing or off.');
    this.isSoftwareRendered = /llvmpipe|swiftshader|software/i.test(graphics);
    // A processor that draws has no time for smooth edges.
    const antialias = !this.isSoftwareRendered;
    this.renderer = new WebGLRenderer({ canvas, antialias, powerPreference: 'high-performance' });
    const ratio = Math.min(window.devicePixelRatio, maxPixelRatio);
    this.renderer.setPixelRatio(this.isSoftwareRendered ? 1 : ratio);
    this.renderer.xr.enabled = true;
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

  /// The next frame has something new to show.
  invalidate(): void {
    this.isDirty = true;
  }

  private frame(time: number, frame?: XRFrame): void {
    const isInVr = this.renderer.xr.isPresenting;
    if (!isInVr && this.shouldWait()) return;
    const state = this.session.latest();
    if (state && this.followsWorld && this.isNews(state)) {
      this.lastShown = state;
      this.view.showState(state);
      this.isDirty = true;
    }
    const seconds = Number.isFinite(this.lastFrame) ? (time - this.lastFrame) / 1000 : 0;
    this.lastFrame = time;
    for (const callback of this.callbacks) callback(time, seconds, frame);
    if (!this.isDirty && !isInVr) return;
    this.isDirty = false;
    this.renderer.render(this.scene, this.camera);
    this.session.drawn();
    for (const callback of this.drawnCallbacks) callback();
  }

  /// At rest nothing is drawn again and again; while the tool is held, everything is, at once.
  private isNews(state: LiveState): boolean {
    if (state === this.lastShown) return false;
    return !this.lastShown || state.isEngaged || looksDifferent(this.lastShown, state);
  }

  /// A busy browser prefers frames to messages: a few frames given up let the newest state in.
  private shouldWait(): boolean {
    const isStale =
      this.session.latest() !== null && this.session.latency.lag(pageClock()) > staleSeconds;
    this.waits = isStale && this.waits < maxWaits ? this.waits + 1 : 0;
    return this.waits > 0;
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

/// What draws here, as the browser calls it.
function graphicsName(): string {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = gl ? String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return name;
}
