// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BackSide,
  ConeGeometry,
  CylinderGeometry,
  Group,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  SphereGeometry,
  TorusGeometry,
  Vector3,
} from 'three';
import { toolColors } from '../palette';
import type { LiveState, Vector } from '../protocol';
import { showThrough } from './see_through';
import { Segment } from './segment';

const metresPerNewton = 0.01; // an arrow of 10 cm at 10 N
const maxArrow = 0.3; // [m]
const minForce = 0.05; // [N] below, the arrow would show noise
const pulseSeconds = 0.35;

/// The tool: the proxy (god-object: a sphere of the tool's size, outside of all surfaces), the HIP
/// (haptic interface point: where the hand is), a line between them, the force on the hand, pulses.
export class ToolView {
  readonly group = new Group();
  readonly proxy = new Mesh(
    new SphereGeometry(1, 32, 20),
    new MeshLambertMaterial({ color: toolColors.ball }),
  );
  // The back of a slightly larger black sphere: a rim that shows the ball on any background.
  private readonly rim = new Mesh(
    new SphereGeometry(1.16, 32, 20),
    new MeshBasicMaterial({ color: toolColors.rim, side: BackSide }),
  );
  readonly hip = new Mesh(
    new SphereGeometry(1, 20, 12),
    new MeshBasicMaterial({
      color: toolColors.force,
      transparent: true,
      opacity: 0.85,
      depthTest: false,
    }),
  );
  force: Vector = [0, 0, 0];
  private spring = new Segment(
    new LineBasicMaterial({ color: toolColors.force, depthTest: false }),
  );
  private arrow = new Group();
  private shaft: Mesh;
  private head: Mesh;
  private ring = new Mesh(
    new TorusGeometry(1, 0.06, 8, 48),
    new MeshBasicMaterial({ color: toolColors.touch, transparent: true, depthWrite: false }),
  );
  radius = 0.01; // [m]
  private pulses = -1;
  private pulseStart = -Infinity;

  constructor(base: Group) {
    this.group.name = 'tool';
    this.group.visible = false;
    const material = new MeshLambertMaterial({ color: toolColors.force });
    this.shaft = new Mesh(new CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0), material);
    this.head = new Mesh(new ConeGeometry(1, 1, 20).translate(0, 0.5, 0), material);
    this.arrow.add(this.shaft, this.head);
    this.ring.visible = false;
    this.hip.renderOrder = 2;
    this.spring.renderOrder = 1;
    this.group.add(this.proxy, this.hip, this.spring, this.arrow, this.ring);
    this.proxy.add(this.rim);
    base.add(this.group);
    this.setRadius(this.radius);
  }

  /// [m]
  setRadius(radius: number): void {
    this.radius = radius;
    this.proxy.scale.setScalar(radius);
    this.hip.scale.setScalar(0.45 * radius);
  }

  showContact(state: LiveState): void {
    const touches = state.touchesScan || state.touchedObject >= 0;
    this.proxy.material.color.set(touches ? toolColors.touch : toolColors.ball);
    if (this.pulses >= 0 && state.pulses !== this.pulses)
      this.pulseStart = performance.now() / 1000;
    this.pulses = state.pulses;
  }

  show(proxy: Readonly<Vector>, hip: Readonly<Vector>, force: Readonly<Vector>): void {
    this.group.visible = true;
    this.proxy.position.fromArray(proxy);
    this.hip.position.fromArray(hip);
    this.spring.join(hip, proxy);
    this.force = [...force];
    this.showForce();
    this.proxy.updateWorldMatrix(true, false);
    showThrough(this.proxy.getWorldPosition(new Vector3()), this.radius);
  }

  /// Without a server the force is not known.
  forgetForce(): void {
    this.force = [NaN, NaN, NaN];
    this.arrow.visible = false;
  }

  hide(): void {
    this.group.visible = false;
    showThrough(new Vector3(), 0);
  }

  /// The tip of the force arrow in world coordinates; null if it is not drawn.
  arrowTip(): Vector3 | null {
    if (!this.group.visible || !this.arrow.visible) return null;
    this.arrow.updateWorldMatrix(true, false);
    return this.arrow.localToWorld(new Vector3(0, this.head.position.y + this.head.scale.y, 0));
  }

  /// Animates a pulse's ring; true while it needs a redraw. `reducedMotion`: fading, no growth.
  animate(now: number, reducedMotion: boolean): boolean {
    const progress = (now - this.pulseStart) / pulseSeconds;
    const isOn = progress >= 0 && progress < 1;
    const wasOn = this.ring.visible;
    this.ring.visible = isOn;
    if (isOn) {
      this.ring.position.copy(this.proxy.position);
      this.ring.scale.setScalar(this.radius * (reducedMotion ? 1.8 : 1.2 + 2.2 * progress));
      this.ring.material.opacity = 1 - progress;
    }
    return isOn || wasOn;
  }

  private showForce(): void {
    const force = new Vector3(...this.force);
    const newtons = force.length();
    this.arrow.visible = newtons > minForce;
    if (!this.arrow.visible) return;
    const length = Math.min(newtons * metresPerNewton, maxArrow);
    const headLength = Math.min(0.4 * length, 0.03);
    this.arrow.position.copy(this.proxy.position);
    this.arrow.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), force.normalize());
    this.shaft.scale.set(0.003, length - headLength, 0.003);
    this.head.scale.set(0.35 * headLength, headLength, 0.35 * headLength);
    this.head.position.y = length - headLength;
  }
}
