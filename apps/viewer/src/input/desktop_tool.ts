// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import { Command, Device, type LiveState, type Quaternion, type Vector } from '../protocol';
import { DragPlane, type PlaneKind } from './drag_plane';
import { HeldKeys } from './keys';
import { levelDirection } from './navigation';
import type { Picking } from './picking';

const keySpeed = 0.15; // [m/s]; with Shift a quarter of it
const maxReach = 0.06; // [m] from the ball to the tip: a key held against a wall winds up no more
const noTurn: Quaternion = [0, 0, 0, 1];
const toolKeys = ['Space', 'ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight', 'PageUp', 'PageDown'];

/// The tool by mouse and keyboard: a handle to drag, or Space and the arrow keys. While one of them
/// holds it the clutch is closed, and the tip goes to the world once a frame.
export class DesktopTool {
  isEnabled = false;
  isClutchLocked = false; // the clutch button: like Space, held for good
  planeKind: 'level' | 'view' = 'level';
  private readonly keys: HeldKeys;
  private drag: DragPlane | null = null;
  private dragKind: PlaneKind = 'level';
  private pointer = { x: 0, y: 0 };
  private tip: Vector3 | null = null; // in base, while the clutch is closed
  private device: Device = Device.mouse;
  private isRefused = false; // another page has the tool: whoever wants it takes hold anew

  constructor(
    private readonly app: App,
    private readonly picking: Picking,
    private readonly handle: HTMLButtonElement,
  ) {
    this.keys = new HeldKeys([app.canvas, handle], [...toolKeys, 'ShiftLeft', 'ShiftRight']);
    handle.addEventListener('pointerdown', (event) => this.grab(event));
    handle.addEventListener('pointermove', (event) => this.follow(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      handle.addEventListener(name, () => this.endDrag());
    window.addEventListener('blur', () => this.letGo());
    document.addEventListener('visibilitychange', () => this.letGo());
    // The scene keeps the focus, and with it the keys to walk by.
    handle.addEventListener('mousedown', (event) => event.preventDefault());
    const focusable: HTMLElement[] = [app.canvas, handle];
    for (const element of focusable)
      element.addEventListener('keydown', (event) => event.key === 'Escape' && this.letGo());
  }

  get isHeld(): boolean {
    return this.tip !== null;
  }

  /// Opens the clutch, whatever holds it.
  letGo(): void {
    this.endDrag();
    this.isClutchLocked = false;
  }

  /// Once a frame, `seconds` after the one before.
  update(seconds: number): void {
    const state = this.app.session.latest();
    if (!state) this.letGo(); // whoever finds the world again takes hold anew
    const isWanted =
      this.isEnabled &&
      state !== null &&
      !state.isOnHold &&
      !this.app.renderer.xr.isPresenting &&
      (this.drag !== null || this.keys.has('Space') || this.isClutchLocked);
    if (!isWanted) this.isRefused = false;
    if (!isWanted || !this.ask(state)) return this.open(state);
    this.tip ??= new Vector3(...state.proxy);
    if (this.drag) this.moveByPointer();
    else this.moveByKeys(seconds, new Vector3(...state.proxy));
    this.app.session.sendTool(this.tip.toArray() as Vector, noTurn, true, this.device);
  }

  /// True once this page may move the tool.
  private ask(state: LiveState): boolean {
    if (state.hasTool) return true;
    if (this.isRefused) return false;
    if (state.isToolTaken) {
      this.letGo();
      this.isRefused = true;
      this.app.notify({ level: 'warning', text: 'Another page has the tool.' });
      return false;
    }
    this.app.session.command(Command.take);
    return true;
  }

  private open(state: LiveState | null): void {
    if (!this.tip) return;
    if (state) this.app.session.sendTool(this.tip.toArray() as Vector, noTurn, false, this.device);
    this.tip = null;
  }

  private grab(event: PointerEvent): void {
    if (!this.isEnabled || event.button !== 0) return;
    const state = this.app.session.latest();
    if (!state) return;
    this.handle.setPointerCapture(event.pointerId);
    this.app.canvas.focus({ preventScroll: true });
    this.pointer = { x: event.clientX, y: event.clientY };
    this.tip ??= new Vector3(...state.proxy);
    this.device = Device.mouse;
    this.startPlane(event.shiftKey);
  }

  private follow(event: PointerEvent): void {
    if (!this.drag) return;
    this.pointer = { x: event.clientX, y: event.clientY };
    if (this.dragKind !== (event.shiftKey ? 'upright' : this.planeKind))
      this.startPlane(event.shiftKey);
  }

  private endDrag(): void {
    this.drag = null;
  }

  private startPlane(isUpright: boolean): void {
    if (!this.tip) return;
    this.dragKind = isUpright ? 'upright' : this.planeKind;
    const ray = this.picking.rayAt(this.pointer.x, this.pointer.y).ray;
    const tool = this.app.base.localToWorld(this.tip.clone());
    this.drag = DragPlane.through(tool, this.dragKind, this.app.camera, ray);
  }

  private moveByPointer(): void {
    const tool = this.drag?.move(this.picking.rayAt(this.pointer.x, this.pointer.y).ray);
    if (tool) this.tip = this.app.base.worldToLocal(tool);
  }

  private moveByKeys(seconds: number, proxy: Vector3): void {
    const forward = levelDirection(this.app.camera);
    const right = new Vector3(-forward.z, 0, forward.x);
    const isFine = this.keys.has('ShiftLeft') || this.keys.has('ShiftRight');
    const step = forward
      .multiplyScalar(this.keys.axis('ArrowUp', 'ArrowDown'))
      .addScaledVector(right, this.keys.axis('ArrowRight', 'ArrowLeft'))
      .add(new Vector3(0, this.keys.axis('PageUp', 'PageDown'), 0))
      .multiplyScalar(keySpeed * seconds * (isFine ? 0.25 : 1));
    if (step.lengthSq() === 0) return;
    this.device = Device.keyboard;
    const turn = this.app.base.getWorldQuaternion(this.app.camera.quaternion.clone()).invert();
    this.tip!.add(step.applyQuaternion(turn));
    const reach = this.tip!.clone().sub(proxy);
    if (reach.length() > maxReach) this.tip!.copy(proxy).add(reach.setLength(maxReach));
  }
}
