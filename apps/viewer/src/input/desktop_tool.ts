// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import { Command, Device, type LiveState, type Quaternion, type Vector } from '../protocol';
import { BodyDrag } from './body_drag';
import { DragPlane, type PlaneKind } from './drag_plane';
import { HeldKeys } from './keys';
import { Misses } from './misses';
import { horizontalDirection } from './navigation';
import { pageClock } from '../session/clock';
import type { Picking } from './picking';
import { PointerTrail, type PointerPosition } from './pointer_trail';
import { SmoothFollower } from './smooth_follower';
import { pushHeight, type Obstacle } from './push_height';

const samplePeriod = 0.008; // [s] not the drawing rate: a slow picture must not make jerky forces
const maxCatchUp = 0.9; // [s] a window that hung for longer makes up for its last moves only
const lateSeconds = 0.02; // a timer that is later than this first lets the input come that waits
const maxDragSpeed = 0.6; // [m/s] of the tip after the pointer: no hit where events come late
const finishSeconds = 1.5; // after a drag, for the tip to come to where the pointer was let go
const keySpeed = 0.15; // [m/s]; with Shift a quarter of it
const heightSpeed = 0.3; // [m/s] of a level motion to the height at which it pushes
const maxLead = 0.06; // [m] of the tip over the proxy: anti-windup while a key pushes into a wall
const identityRotation: Quaternion = [0, 0, 0, 1];
const toolKeys = ['Space', 'ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight', 'PageUp', 'PageDown'];

/// The tool by mouse, touch and keyboard: a ring to drag, its handle for the height, a body to
/// press and drag, or Space and the arrow keys. While one of them is in use the clutch is closed,
/// and the tip is sent to the server as it is at each 8 ms, whatever the drawing rate: a window that
/// was busy makes up for them from the times of the pointer's moves. A level motion goes at the height
/// at which it pushes, until the operator has chosen another one.
export class DesktopTool {
  isEnabled = false;
  isClutchLocked = false; // by the clutch button: as Space held down
  planeKind: 'horizontal' | 'view' = 'horizontal';
  readonly misses = new Misses();
  private readonly keys: HeldKeys;
  private readonly bodyDrag: BodyDrag;
  private drag: DragPlane | null = null;
  private dragKind: PlaneKind = 'horizontal';
  private readonly trail = new PointerTrail();
  private readonly follower = new SmoothFollower();
  private releasedAt = Infinity; // [s] of the page's clock, when the pointer was let go
  private isHeightChosen = false; // by the operator, since the tool was free
  private tip: Vector3 | null = null; // in base, while the clutch is closed
  private device: Device = Device.mouse;
  private isRefused = false; // another page has the tool: release the input and press again
  private target: Vector3 | null = null; // in base, where the pointer is on its plane
  private finishUntil = -Infinity; // [s] of the page's clock, after a drag
  private lastSent = NaN; // [s] clock of the newest sample
  private lastUpdate = pageClock(); // [s]
  private hasWaited = false; // for input, since the last update

  constructor(
    private readonly app: App,
    private readonly picking: Picking,
    handle: HTMLButtonElement,
    heightHandle: HTMLButtonElement,
  ) {
    this.keys = new HeldKeys([app.canvas, handle], [...toolKeys, 'ShiftLeft', 'ShiftRight']);
    this.bodyDrag = new BodyDrag(app, picking, () => this.canStart());
    this.connect(handle, (event) => event.shiftKey);
    this.connect(heightHandle, () => true);
    setInterval(() => this.tick(), 1000 * samplePeriod);
    window.addEventListener('blur', () => this.disengage());
    document.addEventListener('visibilitychange', () => this.disengage());
    const focusable: HTMLElement[] = [app.canvas, handle];
    for (const element of focusable)
      element.addEventListener('keydown', (event) => event.key === 'Escape' && this.disengage());
  }

  private connect(handle: HTMLElement, isVertical: (event: PointerEvent) => boolean): void {
    handle.addEventListener('pointerdown', (event) =>
      this.startDrag(handle, event, isVertical(event)),
    );
    const update = (event: Event) =>
      this.updateDrag(event as PointerEvent, isVertical(event as PointerEvent));
    // A move comes with a drawn frame, a raw update at once; not all browsers have it.
    for (const name of ['pointermove', 'pointerrawupdate']) handle.addEventListener(name, update);
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      handle.addEventListener(name, () => this.endDrag());
    // The canvas keeps the focus, and with it the navigation keys.
    handle.addEventListener('mousedown', (event) => event.preventDefault());
  }

  get isEngaged(): boolean {
    return this.tip !== null;
  }

  /// Whether the tool goes to where the pointer is, or was let go.
  get isPointed(): boolean {
    return this.target !== null || this.bodyDrag.isActive;
  }

  /// Opens the clutch, whichever input has closed it.
  disengage(): void {
    this.drag = null;
    this.target = null;
    this.finishUntil = -Infinity;
    this.bodyDrag.end();
    this.isClutchLocked = false;
    if (this.tip) this.app.session.openClutch();
  }

  /// A level motion goes at the height of the bodies again.
  forgetHeight(): void {
    this.isHeightChosen = false;
  }

  private tick(): void {
    const now = pageClock();
    const since = now - this.lastUpdate;
    if (since > lateSeconds && !this.hasWaited) {
      this.hasWaited = true;
      setTimeout(() => this.tick());
      return;
    }
    this.hasWaited = false;
    const missed = Math.min(since, this.isEngaged ? maxCatchUp : samplePeriod);
    const steps = Math.max(1, Math.round(missed / samplePeriod));
    for (let step = steps - 1; step >= 0; --step) {
      const time = now - (step * missed) / steps;
      this.update(missed / steps, time);
      this.settle(time);
    }
    this.lastUpdate = now;
  }

  /// Ends what was let go up to `time` [s].
  private settle(time: number): void {
    const state = this.app.session.latest();
    this.bodyDrag.settle(time, state !== null && state.toolClock >= this.lastSent);
    if (!this.drag || time < this.releasedAt) return;
    this.finishUntil = time + finishSeconds;
    this.drag = null;
  }

  private update(seconds: number, now: number): void {
    const state = this.app.session.latest();
    if (!state) this.interrupt();
    const isPointing =
      this.drag !== null ||
      this.bodyDrag.isActive ||
      (state !== null && this.isFinishing(state, now));
    const isRequested =
      this.isEnabled &&
      state !== null &&
      !state.isOnHold &&
      !this.app.renderer.xr.isPresenting &&
      (isPointing || this.keys.has('Space') || this.isClutchLocked);
    if (!isRequested) this.isRefused = false;
    if (!isRequested || !this.acquire(state)) return this.openClutch(state);
    const tool = new Vector3(...state.proxy);
    // The clutch closes where the tool is: the first sample is of a tip that has not moved yet.
    if (!this.tip) this.tip = tool.clone();
    else this.move(seconds, now, this.tip, tool);
    this.misses.add(state, tool, this.radius, this.obstacles());
    this.lastSent = now;
    this.app.session.sendTool(
      this.tip.toArray() as Vector,
      identityRotation,
      true,
      this.device,
      now,
    );
  }

  /// After a gap the input has to be pressed again, which is said: a held button does nothing then.
  private interrupt(): void {
    if (this.drag || this.bodyDrag.isActive)
      this.app.notify({
        level: 'warning',
        text: 'The drag has ended with the connection: press again.',
      });
    this.disengage();
  }

  private move(seconds: number, now: number, tip: Vector3, tool: Vector3): void {
    if (this.bodyDrag.isActive)
      return this.bodyDrag.move(seconds, now, tip, tool, this.obstacles());
    if (this.drag) this.aimOnPlane(this.trail.at(now));
    if (this.target) this.moveByPointer(seconds, tip, this.target);
    else this.moveByKeys(seconds, tip, tool);
  }

  /// Whether a drag that has ended is still to be followed, and to be shown by the world.
  private isFinishing({ toolClock }: LiveState, now: number): boolean {
    if (now > this.finishUntil || !this.target) return false;
    const isReached = this.tip !== null && this.tip.distanceTo(this.target) < 1e-4;
    return !isReached || !(toolClock >= this.lastSent);
  }

  private get radius(): number {
    return this.app.view.tool.radius;
  }

  private obstacles(): Obstacle[] {
    return this.app.view.bodies.map(({ object, boxInBase }) => ({
      name: object.name,
      box: boxInBase,
      isMovable: object.movable,
    }));
  }

  /// Requests the tool; true once this page has it.
  private acquire(state: LiveState): boolean {
    if (state.hasTool) return true;
    if (this.isRefused) return false;
    if (state.isToolTaken) {
      this.disengage();
      this.isRefused = true;
      this.app.notify({ level: 'warning', text: 'Another page controls the tool: ask for it.' });
      return false;
    }
    this.app.session.command(Command.take);
    return true;
  }

  private openClutch(state: LiveState | null): void {
    this.target = null;
    if (!this.tip) return;
    if (state)
      this.app.session.sendTool(this.tip.toArray() as Vector, identityRotation, false, this.device);
    this.tip = null;
    this.misses.endDrag();
  }

  private canStart(): boolean {
    const state = this.app.session.latest();
    return this.isEnabled && state !== null && !state.isOnHold && this.drag === null;
  }

  private startDrag(handle: HTMLElement, event: PointerEvent, isVertical: boolean): void {
    if (!this.isEnabled || event.button !== 0) return;
    const state = this.app.session.latest();
    if (!state) return;
    this.bodyDrag.end();
    handle.setPointerCapture(event.pointerId);
    this.app.canvas.focus({ preventScroll: true });
    const isFinishing = this.finishUntil > pageClock() || this.releasedAt < Infinity;
    if (this.tip && isFinishing) this.misses.endDrag(); // the last drag's tip is still on its way
    this.trail.start(event);
    this.follower.reset();
    this.releasedAt = Infinity;
    this.target = (this.tip ?? new Vector3(...state.proxy)).clone();
    this.device = Device.mouse;
    this.startPlane(isVertical);
  }

  private updateDrag(event: PointerEvent, isVertical: boolean): void {
    if (!this.drag) return;
    this.trail.add(event);
    if (this.dragKind === (isVertical ? 'vertical' : this.planeKind)) return;
    this.aimOnPlane(this.trail.newest); // up to here on the old plane
    this.startPlane(isVertical);
  }

  private endDrag(): void {
    if (this.drag) this.releasedAt = Math.min(this.releasedAt, pageClock());
  }

  private startPlane(isVertical: boolean): void {
    if (!this.target) return;
    this.dragKind = isVertical ? 'vertical' : this.planeKind;
    this.isHeightChosen ||= this.dragKind !== 'horizontal';
    const { x, y } = this.trail.newest;
    const ray = this.picking.rayAt(x, y).ray;
    const tool = this.app.base.localToWorld(this.target.clone());
    this.drag = DragPlane.through(tool, this.dragKind, this.app.camera, ray);
  }

  private moveByPointer(seconds: number, tip: Vector3, target: Vector3): void {
    this.follower.follow(seconds, tip, target, maxDragSpeed);
    if (this.dragKind !== 'horizontal' || !this.moveToPushHeight(seconds, tip)) return;
    target.z = tip.z;
    if (this.drag) this.startPlane(false);
  }

  private aimOnPlane({ x, y }: PointerPosition): void {
    const tool = this.drag?.move(this.picking.rayAt(x, y).ray);
    if (tool) this.target = this.app.base.worldToLocal(tool);
  }

  /// Whether the height was changed.
  private moveToPushHeight(seconds: number, tip: Vector3): boolean {
    if (this.isHeightChosen) return false;
    const height = pushHeight(tip, this.radius, this.obstacles());
    if (height === null) return false;
    const maxStep = heightSpeed * seconds;
    tip.z += Math.min(Math.max(height - tip.z, -maxStep), maxStep);
    return true;
  }

  private moveByKeys(seconds: number, tip: Vector3, proxy: Vector3): void {
    const forward = horizontalDirection(this.app.camera);
    const right = new Vector3(-forward.z, 0, forward.x);
    const isFine = this.keys.has('ShiftLeft') || this.keys.has('ShiftRight');
    const up = this.keys.axis('PageUp', 'PageDown');
    this.isHeightChosen ||= up !== 0;
    const step = forward
      .multiplyScalar(this.keys.axis('ArrowUp', 'ArrowDown'))
      .addScaledVector(right, this.keys.axis('ArrowRight', 'ArrowLeft'))
      .add(new Vector3(0, up, 0))
      .multiplyScalar(keySpeed * seconds * (isFine ? 0.25 : 1));
    if (step.lengthSq() === 0) return;
    this.device = Device.keyboard;
    const toBase = this.app.base.getWorldQuaternion(this.app.camera.quaternion.clone()).invert();
    tip.add(step.applyQuaternion(toBase));
    this.moveToPushHeight(seconds, tip);
    const lead = tip.clone().sub(proxy);
    if (lead.length() > maxLead) tip.copy(proxy).add(lead.setLength(maxLead));
  }
}
