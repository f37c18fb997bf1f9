// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3, Vector3, type PerspectiveCamera } from 'three';
import type { Body } from '../scene/bodies';
import type { SceneView } from '../scene/view';
import { byId, create, setText } from './dom';
import { length, newtons } from './format';
import { phaseLabel, setPhaseColor } from './objects_panel';

const maxLabels = 24; // more would hide the scene
const edgeGap = { x: 64, y: 24 }; // [CSS pixels] of the robot's label from the stage's edge
const ringArea = { side: 130, above: 86, below: 36 }; // [CSS pixels] around the ring's centre
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
    title: 'The robot stands here: the origin of all coordinates.',
  });
  private readonly heights = new Map<Body, number>();

  constructor(
    private readonly view: SceneView,
    private readonly stage: HTMLElement,
  ) {
    for (const body of view.bodies.filter((b) => b.object.movable).slice(0, maxLabels)) {
      const label = create('span', { className: 'phase' });
      this.labels.set(body, label);
      this.container.append(label);
    }
    this.container.append(this.robot);
  }

  /// `isFlat`: rendered on the page, not in a headset, where overlay labels would be misplaced.
  update(isFlat: boolean): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const { layers } = this.view;
    const isShown = isFlat && layers.isShown('labels') && layers.isShown('bodies');
    this.container.hidden = !isShown;
    this.force.hidden = true;
    if (isShown) this.placeRobot(width, height);
    if (isShown) for (const [body, label] of this.labels) this.place(body, label, width, height);
    if (isFlat) this.placeForce(width, height);
  }

  private place(body: Body, label: HTMLSpanElement, width: number, height: number): void {
    const top = body.solid.getWorldPosition(new Vector3());
    top.y += this.halfHeight(body) + 0.015;
    const at = project(top, this.view.camera, width, height);
    label.hidden = at === null;
    if (!at) return;
    setText(label, `${body.object.name} · ${phaseLabel(body)}`);
    setPhaseColor(label, body);
    label.style.transform = `translate(${at.x.toFixed(0)}px, ${at.y.toFixed(0)}px) translate(-50%, -100%)`;
  }

  /// At the robot's base; where that is outside of the picture, at the edge towards it.
  private placeRobot(width: number, height: number): void {
    const { camera, base } = this.view;
    const origin = base.getWorldPosition(new Vector3());
    const at = project(origin, camera, width, height);
    const isInside = at && at.x > 0 && at.x < width && at.y > 0 && at.y < height;
    this.robot.classList.toggle('outside', !isInside);
    setText(this.robot, isInside ? 'robot' : 'robot is this way');
    if (isInside) {
      const y = this.clearOfTool(at, width, height);
      this.robot.style.transform = `translate(${at.x.toFixed(0)}px, ${y.toFixed(0)}px) translate(-50%, -50%)`;
      return;
    }
    // The direction on the picture, also of a point behind the camera.
    const { x, y } = origin.applyMatrix4(camera.matrixWorldInverse);
    const [halfWidth, halfHeight] = [width / 2 - edgeGap.x, height / 2 - edgeGap.y];
    const scale = Math.min(halfWidth / Math.abs(x), halfHeight / Math.abs(y));
    const [left, top] = [width / 2 + scale * x, height / 2 - scale * y];
    this.robot.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px) translate(-50%, -50%)`;
    const degrees = (Math.atan2(-y, x) * 180) / Math.PI;
    this.robot.style.setProperty('--towards', `${degrees.toFixed(0)}deg`);
  }

  /// The height of a label at `at` that is not behind the tool's ring and what is said above it.
  private clearOfTool(at: { x: number; y: number }, width: number, height: number): number {
    const { tool, camera } = this.view;
    const ring =
      tool.group.visible &&
      project(tool.proxy.getWorldPosition(new Vector3()), camera, width, height);
    if (!ring || Math.abs(at.x - ring.x) > ringArea.side) return at.y;
    const isClear = at.y < ring.y - ringArea.above || at.y > ring.y + ringArea.below;
    return isClear ? at.y : Math.max(ring.y - ringArea.above, edgeGap.y);
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
