// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3, Vector3, type PerspectiveCamera } from 'three';
import { phaseColors, type Body } from '../scene/bodies';
import type { SceneView } from '../scene/view';
import { byId, create, setText } from './dom';
import { length, newtons } from './format';
import { phaseWord } from './objects_panel';

const maxLabels = 24; // more would only hide the scene
const minForceShown = 0.05; // [N]

/// Where a point of the world stands in the picture [CSS pixels]; null behind the camera.
export function project(
  point: Vector3,
  camera: PerspectiveCamera,
  width: number,
  height: number,
): { x: number; y: number } | null {
  const p = point.clone().project(camera);
  if (p.z > 1 || p.z < -1) return null;
  return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height };
}

export function moveTo(element: HTMLElement, x: number, y: number): void {
  element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
}

/// Names and phases above the bodies, and the force beside its arrow.
export class Labels {
  private readonly folder = byId('labels', HTMLDivElement);
  private readonly force = byId('force-value', HTMLSpanElement);
  private readonly labels = new Map<Body, HTMLSpanElement>();
  private readonly heights = new Map<Body, number>();

  constructor(
    private readonly view: SceneView,
    private readonly stage: HTMLElement,
  ) {
    for (const body of view.bodies.filter((b) => b.object.movable).slice(0, maxLabels)) {
      const label = create('span', { className: 'phase' });
      this.labels.set(body, label);
      this.folder.append(label);
    }
  }

  /// `isFlat`: on the page; in a headset they would be beside what they name.
  update(isFlat: boolean): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const { layers } = this.view;
    const isShown = isFlat && layers.isShown('labels') && layers.isShown('bodies');
    this.folder.hidden = !isShown;
    this.force.hidden = true;
    if (isShown) for (const [body, label] of this.labels) this.place(body, label, width, height);
    if (isFlat) this.placeForce(width, height);
  }

  private place(body: Body, label: HTMLSpanElement, width: number, height: number): void {
    const top = body.solid.getWorldPosition(new Vector3());
    top.y += this.halfHeight(body) + 0.015;
    const at = project(top, this.view.camera, width, height);
    label.hidden = at === null;
    if (!at) return;
    setText(label, `${body.object.name} · ${phaseWord(body)}`);
    label.style.setProperty('--phase', phaseColors[body.phase]);
    label.style.transform = `translate(${at.x.toFixed(0)}px, ${at.y.toFixed(0)}px) translate(-50%, -100%)`;
  }

  /// [m] from a body's origin to the top of it, once its shape has come.
  private halfHeight(body: Body): number {
    const known = this.heights.get(body);
    if (known !== undefined) return known;
    const box = new Box3().expandByObject(body.solid);
    if (box.isEmpty()) return 0;
    const height = box.max.y - body.solid.getWorldPosition(new Vector3()).y;
    this.heights.set(body, height);
    return height;
  }

  private placeForce(width: number, height: number): void {
    const { tool } = this.view;
    const newton = length(tool.force);
    const tip = tool.arrowTip();
    const at = tip && project(tip, this.view.camera, width, height);
    if (!tool.group.visible || newton < minForceShown || !at) return;
    this.force.hidden = false;
    setText(this.force, newtons(newton));
    // Beyond the tip, on whichever side that is: it would hide the arrow.
    const ball = project(
      tool.proxy.getWorldPosition(new Vector3()),
      this.view.camera,
      width,
      height,
    );
    const isLeft = ball !== null && at.x < ball.x;
    moveTo(this.force, at.x + (isLeft ? -10 : 10), at.y - 10);
    this.force.style.translate = isLeft ? '-100%' : 'none';
  }
}
