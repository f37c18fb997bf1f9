// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3, Vector3, type PerspectiveCamera } from 'three';
import type { Body } from '../scene/bodies';
import { isHidden } from '../scene/hidden';
import { hasRobotBase } from '../scene/scene_model';
import type { SceneView } from '../scene/view';
import { byId, create, setText } from './dom';
import { length, newtons } from './format';
import { clearOf, type Area } from './label_layout';
import { phaseLabel, setPhaseColor } from './objects_panel';

const maxLabels = 24; // more would hide the scene
const edgeGap = { x: 64, y: 24 }; // [CSS pixels] of the robot's label from the stage's edge
const inFront = ['handle', 'height-handle', 'call-to-action', 'status-lines']; // of the labels, which move aside
const belowRobot = -0.4; // [heights of its label] so that its axes are seen
const minForceShown = 0.05; // [N]

/// Projects a world point to the canvas [CSS pixels]; null outside of the near and far planes.
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

/// Names and phases above the bodies, and the force's magnitude next to its arrow.
export class Labels {
  private readonly container = byId('labels', HTMLDivElement);
  private readonly force = byId('force-value', HTMLSpanElement);
  private readonly labels = new Map<Body, HTMLSpanElement>();
  private readonly robot = create('span', {
    className: 'robot',
    title: 'The robot stands here.',
  });
  private readonly heights = new Map<Body, number>();
  private readonly sizes = new Map<HTMLElement, { width: number; height: number }>();
  private taken: Area[] = [];

  constructor(
    private readonly view: SceneView,
    private readonly stage: HTMLElement,
  ) {
    for (const body of view.bodies.filter((b) => b.object.movable).slice(0, maxLabels)) {
      const label = create('span', { className: 'phase' });
      this.labels.set(body, label);
      this.container.append(label);
    }
    if (view.model && hasRobotBase(view.model)) this.container.append(this.robot);
  }

  /// `isFlat`: rendered on the page, not in a headset, where overlay labels would be misplaced.
  update(isFlat: boolean): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const { layers } = this.view;
    const isShown = isFlat && layers.isShown('labels') && layers.isShown('bodies');
    this.container.hidden = !isShown;
    this.force.hidden = true;
    if (isShown) {
      this.taken = this.areasInFront();
      for (const [body, label] of this.labels) this.place(body, label, width, height);
      this.placeRobot(width, height);
    }
    if (isFlat) this.placeForce(width, height);
  }

  private place(body: Body, label: HTMLSpanElement, width: number, height: number): void {
    const top = body.solid.getWorldPosition(new Vector3());
    top.y += this.halfHeight(body) + 0.015;
    const at = project(top, this.view.camera, width, height);
    label.hidden = at === null || isHidden(body, this.view.bodies, this.view.camera.position);
    if (!at || label.hidden) return;
    this.setLabel(label, `${body.object.name} · ${phaseLabel(body)}`);
    setPhaseColor(label, body);
    this.putAside(label, at.x, at.y, 1);
  }

  private areasInFront(): Area[] {
    const stage = this.stage.getBoundingClientRect();
    return inFront
      .map((id) => byId(id, HTMLElement))
      .filter((element) => !element.hidden)
      .map((element) => {
        const { left, top, width, height } = element.getBoundingClientRect();
        return { left: left - stage.left, top: top - stage.top, width, height };
      });
  }

  private setLabel(label: HTMLElement, text: string): void {
    if (label.textContent === text && this.sizes.get(label)?.width) return;
    setText(label, text);
    this.sizes.set(label, { width: label.offsetWidth, height: label.offsetHeight });
  }

  /// Puts a label, centred at x, with `above` of its height above y, beside what is there.
  private putAside(label: HTMLElement, x: number, y: number, above: number): void {
    const { width, height } = this.sizes.get(label) ?? { width: 0, height: 0 };
    const wanted = { left: x - width / 2, top: y - above * height, width, height };
    const { clientWidth, clientHeight } = this.stage;
    const area = clearOf(wanted, this.taken, { width: clientWidth, height: clientHeight });
    this.taken.push(area);
    label.style.transform = `translate(${area.left.toFixed(0)}px, ${area.top.toFixed(0)}px)`;
  }

  /// Where the arm stands, without one at the base frame's origin; where that is outside of the
  /// picture, at the edge towards it.
  private placeRobot(width: number, height: number): void {
    const { camera, base, arm } = this.view;
    const origin = (arm?.group ?? base).getWorldPosition(new Vector3());
    const at = project(origin, camera, width, height);
    const isInside = at && at.x > 0 && at.x < width && at.y > 0 && at.y < height;
    this.robot.classList.toggle('outside', !isInside);
    this.setLabel(this.robot, isInside ? 'robot' : 'robot is this way');
    if (isInside) {
      this.putAside(this.robot, at.x, at.y, belowRobot);
      return;
    }
    // The direction on the picture, also of a point behind the camera.
    const { x, y } = origin.applyMatrix4(camera.matrixWorldInverse);
    const [halfWidth, halfHeight] = [width / 2 - edgeGap.x, height / 2 - edgeGap.y];
    const scale = Math.min(halfWidth / Math.abs(x), halfHeight / Math.abs(y));
    const [left, top] = [width / 2 + scale * x, height / 2 - scale * y];
    this.putAside(this.robot, left, top, 0.5);
    const degrees = (Math.atan2(-y, x) * 180) / Math.PI;
    this.robot.style.setProperty('--towards', `${degrees.toFixed(0)}deg`);
  }

  /// [m] from a body's origin to its top; 0 until its mesh is loaded.
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
    const magnitude = length(tool.force);
    const tip = tool.arrowTip();
    const at = tip && project(tip, this.view.camera, width, height);
    if (!tool.group.visible || magnitude < minForceShown || !at) return;
    this.force.hidden = false;
    setText(this.force, newtons(magnitude));
    // On the far side of the tip, so that the arrow is not covered.
    const proxy = project(
      tool.proxy.getWorldPosition(new Vector3()),
      this.view.camera,
      width,
      height,
    );
    const isLeft = proxy !== null && at.x < proxy.x;
    moveTo(this.force, at.x + (isLeft ? -10 : 10), at.y - 10);
    this.force.style.translate = isLeft ? '-100%' : 'none';
  }
}
