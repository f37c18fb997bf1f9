// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import { pageClock } from '../session/clock';
import type { Body } from '../scene/bodies';
import { Approach, placeBehind } from './approach';
import { DragPlane } from './drag_plane';
import type { Picking } from './picking';
import { PointerTrail, type PointerPosition } from './pointer_trail';
import type { Obstacle } from './push_height';
import { SmoothFollower } from './smooth_follower';

const minDrag = 6; // [CSS pixels]; less is a click, which selects the body
const pushSpeed = 0.3; // [m/s] of the tool after a pointer that is ahead of it
const finishSeconds = 5; // after a quick drag: a metre to the body and half a metre of push take 4 s
const reached = 1e-4; // [m] from where the pointer was let go

interface Press {
  body: Body;
  point: Vector3; // on the body, in base
  at: { x: number; y: number }; // in the window
}

/// A movable body pressed and dragged in the scene: the tool goes behind it, seen in the direction
/// of the drag, and pushes it after the pointer, also after it was let go. A press without a drag
/// stays a click.
export class BodyDrag {
  private press: Press | null = null;
  private readonly trail = new PointerTrail();
  private readonly follower = new SmoothFollower();
  private releasedAt = Infinity; // [s] of the page's clock
  private plane: DragPlane | null = null; // from the drag's start on
  private approach: Approach | null = null;
  private offset = new Vector3(); // from the pressed point to the tool behind the body, in base
  private letGo: Vector3 | null = null; // the pressed point there, in base: the view may turn since
  private isReached = false; // by the tip, where the pointer is

  constructor(
    private readonly app: App,
    private readonly picking: Picking,
    private readonly canStart: () => boolean,
  ) {
    const { canvas } = app;
    // Before the camera's controls, which would turn the view.
    canvas.addEventListener('pointerdown', (event) => this.start(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.update(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      canvas.addEventListener(name, (event) => this.release(event), { capture: true });
  }

  get isActive(): boolean {
    return this.plane !== null;
  }

  end(): void {
    this.press = null;
    this.plane = null;
    this.approach = null;
    this.isReached = false;
  }

  private get isHeld(): boolean {
    return this.press !== null && this.releasedAt === Infinity;
  }

  /// For each time: moves `tip` behind the body, then after the pointer. `tool`: where the tool is.
  move(
    seconds: number,
    now: number,
    tip: Vector3,
    tool: Vector3,
    obstacles: readonly Obstacle[],
  ): void {
    if (!this.press || !this.plane) return;
    this.approach ??= this.approachOf(tip, obstacles);
    if (this.approach && !this.approach.isDone) return this.approach.update(seconds, tip, tool);
    const pushed = now < this.releasedAt ? this.pushedPoint(this.trail.at(now)) : this.letGo;
    if (!pushed) return;
    const target = pushed.clone().add(this.offset).setZ(tip.z);
    this.follower.follow(seconds, tip, target, pushSpeed);
    this.isReached = tip.distanceTo(target) < reached;
  }

  private start(event: PointerEvent): void {
    if (event.button !== 0 || this.isHeld || this.picking.isMeasuring || !this.canStart()) return;
    const hit = this.picking.movableAt(event.clientX, event.clientY);
    if (!hit) return;
    this.end(); // of a drag whose push is still on its way
    event.stopImmediatePropagation();
    event.preventDefault();
    this.app.canvas.focus({ preventScroll: true });
    this.app.canvas.setPointerCapture(event.pointerId);
    this.trail.start(event);
    this.follower.reset();
    this.releasedAt = Infinity;
    this.press = { ...hit, at: this.trail.newest };
  }

  private update(event: PointerEvent): void {
    if (!this.press || !this.isHeld) return;
    this.trail.add(event);
    const { at, point } = this.press;
    const { x, y } = this.trail.newest;
    if (this.plane || Math.hypot(x - at.x, y - at.y) < minDrag) return;
    const { base, camera } = this.app;
    const ray = this.picking.rayAt(at.x, at.y).ray;
    this.plane = DragPlane.through(base.localToWorld(point.clone()), 'horizontal', camera, ray);
  }

  private release(event: PointerEvent): void {
    const { press, plane } = this;
    if (!press || !this.isHeld) return;
    event.stopImmediatePropagation();
    if (plane) {
      this.releasedAt = pageClock();
      this.letGo = this.pushedPoint(this.trail.newest);
      return;
    }
    this.end();
    if (event.type === 'pointerup') this.picking.onPick(press.body);
  }

  /// Ends a drag that was let go up to `time` [s], once the body is pushed to there. `isShown`: the
  /// world has had the last position of the tip.
  settle(time: number, isShown: boolean): void {
    if (!this.plane || time < this.releasedAt) return;
    if ((this.isReached && isShown) || time > this.releasedAt + finishSeconds) this.end();
  }

  /// The pressed point where the pointer at `x`, `y` has dragged it to, in base.
  private pushedPoint({ x, y }: PointerPosition): Vector3 | null {
    const point = this.plane?.move(this.picking.rayAt(x, y).ray);
    return point ? this.app.base.worldToLocal(point) : null;
  }

  private approachOf(tip: Vector3, obstacles: readonly Obstacle[]): Approach | null {
    const { body, point } = this.press!;
    const direction = this.pushedPoint(this.trail.newest)?.sub(point).setZ(0);
    const obstacle = obstacles.find(({ name }) => name === body.object.name);
    if (!direction || direction.lengthSq() === 0 || !obstacle) return null;
    const { radius } = this.app.view.tool;
    const place = placeBehind(point, direction.normalize(), radius, obstacle);
    this.offset = place.clone().sub(point);
    return new Approach(tip, place, radius, obstacles);
  }
}
