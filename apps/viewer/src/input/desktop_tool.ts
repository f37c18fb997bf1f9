// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import { Command, Device, type LiveState, type Quaternion, type Vector } from '../protocol';
import { DragPlane, type PlaneKind } from './drag_plane';
import { HeldKeys } from './keys';
import { horizontalDirection } from './navigation';
import type { Picking } from './picking';

const keySpeed = 0.15; // [m/s]; with Shift a quarter of it
const maxLead = 0.06; // [m] of the tip over the proxy: anti-windup while a key pushes into a wall
const identityRotation: Quaternion = [0, 0, 0, 1];
const toolKeys = ['Space', 'ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight', 'PageUp', 'PageDown'];

/// The tool by mouse and keyboard: a handle to drag, or Space and the arrow keys. While one of them
/// is in use the clutch is closed, and the tip is sent to the server once a frame.
export class DesktopTool {
  isEnabled = false;
  isClutchLocked = false; // by the clutch button: as Space held down
  planeKind: 'horizontal' | 'view' = 'horizontal';
  private readonly keys: HeldKeys;
  private drag: DragPlane | null = null;
  private dragKind: PlaneKind = 'horizontal';
  private pointer = { x: 0, y: 0 };
  private tip: Vector3 | null = null; // in base, while the clutch is closed
  private device: Device = Device.mouse;
  private isRefused = false; // another page has the tool: release the input and press again

  constructor(
    private readonly app: App,
    private readonly picking: Picking,
    private readonly handle: HTMLButtonElement,
  ) {
    this.keys = new HeldKeys([app.canvas, handle], [...toolKeys, 'ShiftLeft', 'ShiftRight']);
    handle.addEventListener('pointerdown', (event) => this.startDrag(event));
    handle.addEventListener('pointermove', (event) => this.updateDrag(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      handle.addEventListener(name, () => this.endDrag());
    window.addEventListener('blur', () => this.disengage());
    document.addEventListener('visibilitychange', () => this.disengage());
    // The canvas keeps the focus, and with it the navigation keys.
    handle.addEventListener('mousedown', (event) => event.preventDefault());
    const focusable: HTMLElement[] = [app.canvas, handle];
    for (const element of focusable)
      element.addEventListener('keydown', (event) => event.key === 'Escape' && this.disengage());
  }

  get isEngaged(): boolean {
    return this.tip !== null;
  }

  /// Opens the clutch, whichever input has closed it.
  disengage(): void {
    this.endDrag();
    this.isClutchLocked = false;
  }

  /// Once a frame, `seconds` after the one before.
  update(seconds: number): void {
    const state = this.app.session.latest();
    if (!state) this.disengage(); // after a reconnect the input has to be pressed again
    const isRequested =
      this.isEnabled &&
      state !== null &&
      !state.isOnHold &&
      !this.app.renderer.xr.isPresenting &&
      (this.drag !== null || this.keys.has('Space') || this.isClutchLocked);
    if (!isRequested) this.isRefused = false;
    if (!isRequested || !this.acquire(state)) return this.openClutch(state);
    this.tip ??= new Vector3(...state.proxy);
    if (this.drag) this.moveByPointer();
    else this.moveByKeys(seconds, new Vector3(...state.proxy));
    this.app.session.sendTool(this.tip.toArray() as Vector, identityRotation, true, this.device);
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
    if (!this.tip) return;
    if (state)
      this.app.session.sendTool(this.tip.toArray() as Vector, identityRotation, false, this.device);
    this.tip = null;
  }

  private startDrag(event: PointerEvent): void {
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

  private updateDrag(event: PointerEvent): void {
    if (!this.drag) return;
    this.pointer = { x: event.clientX, y: event.clientY };
    if (this.dragKind === (event.shiftKey ? 'vertical' : this.planeKind)) return;
    if (this.tip) this.moveByPointer(); // up to here on the old plane: the last frame may be long ago
    this.startPlane(event.shiftKey);
  }

  private endDrag(): void {
    this.drag = null;
  }

  private startPlane(isVertical: boolean): void {
    if (!this.tip) return;
    this.dragKind = isVertical ? 'vertical' : this.planeKind;
    const ray = this.picking.rayAt(this.pointer.x, this.pointer.y).ray;
    const tool = this.app.base.localToWorld(this.tip.clone());
    this.drag = DragPlane.through(tool, this.dragKind, this.app.camera, ray);
  }

  private moveByPointer(): void {
    const tool = this.drag?.move(this.picking.rayAt(this.pointer.x, this.pointer.y).ray);
    if (tool) this.tip = this.app.base.worldToLocal(tool);
  }

  private moveByKeys(seconds: number, proxy: Vector3): void {
    const forward = horizontalDirection(this.app.camera);
    const right = new Vector3(-forward.z, 0, forward.x);
    const isFine = this.keys.has('ShiftLeft') || this.keys.has('ShiftRight');
    const step = forward
      .multiplyScalar(this.keys.axis('ArrowUp', 'ArrowDown'))
      .addScaledVector(right, this.keys.axis('ArrowRight', 'ArrowLeft'))
      .add(new Vector3(0, this.keys.axis('PageUp', 'PageDown'), 0))
      .multiplyScalar(keySpeed * seconds * (isFine ? 0.25 : 1));
    if (step.lengthSq() === 0) return;
    this.device = Device.keyboard;
    const toBase = this.app.base.getWorldQuaternion(this.app.camera.quaternion.clone()).invert();
    this.tip!.add(step.applyQuaternion(toBase));
    const lead = this.tip!.clone().sub(proxy);
    if (lead.length() > maxLead) this.tip!.copy(proxy).add(lead.setLength(maxLead));
  }
}
