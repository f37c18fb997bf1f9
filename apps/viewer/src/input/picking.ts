// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  Raycaster,
  SphereGeometry,
  Vector2,
  Vector3,
  type Object3D,
} from 'three';
import type { Body } from '../scene/bodies';
import type { SceneView } from '../scene/view';

const maxClickPixels = 4; // between press and release; more is a drag
const markColor = '#00a3a3';
const markAngle = 0.004; // [rad] a mark's angular radius

/// Picking by ray casting: a click selects a body; while measuring, two clicks give a distance.
export class Picking {
  isMeasuring = false;
  points: Vector3[] = []; // in base
  onPick: (body: Body | null) => void = () => {};
  onMeasure: (points: readonly Vector3[]) => void = () => {};
  private readonly ray = new Raycaster();
  private readonly marks = new Group();
  private pressed = new Vector2();

  constructor(
    private readonly view: SceneView,
    private readonly canvas: HTMLCanvasElement,
    private readonly invalidate: () => void,
  ) {
    this.ray.params.Points.threshold = 0.005;
    view.base.add(this.marks);
    canvas.addEventListener('pointerdown', (e) => this.pressed.set(e.clientX, e.clientY));
    canvas.addEventListener('pointerup', (event) => {
      const moved = this.pressed.distanceTo(new Vector2(event.clientX, event.clientY));
      if (event.button === 0 && moved < maxClickPixels) this.click(event.clientX, event.clientY);
    });
  }

  setMeasuring(isMeasuring: boolean): void {
    this.isMeasuring = isMeasuring;
    this.points = [];
    this.drawMarks();
  }

  /// The ray through a point in window coordinates.
  rayAt(clientX: number, clientY: number): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(
      (2 * (clientX - box.left)) / box.width - 1,
      1 - (2 * (clientY - box.top)) / box.height,
    );
    this.ray.setFromCamera(at, this.view.camera);
    return this.ray;
  }

  /// The movable body drawn at a point in window coordinates, and where on it, in base.
  movableAt(clientX: number, clientY: number): { body: Body; point: Vector3 } | null {
    const hit = this.hitAt(clientX, clientY);
    const body = hit && this.bodyOf(hit.object);
    if (!hit || !body?.object.movable) return null;
    return { body, point: this.view.base.worldToLocal(hit.point.clone()) };
  }

  private hitAt(clientX: number, clientY: number) {
    const ray = this.rayAt(clientX, clientY);
    const layers = (['bodies', 'mesh', 'cloud', 'occupancy'] as const).filter((name) =>
      this.view.layers.isShown(name),
    );
    const hits = ray.intersectObjects(layers.map((name) => this.view.layers.group(name)));
    return hits.find(({ object }) => object instanceof Mesh || object.type === 'Points');
  }

  private click(clientX: number, clientY: number): void {
    const hit = this.hitAt(clientX, clientY);
    if (this.isMeasuring) {
      if (hit) this.addPoint(this.view.base.worldToLocal(hit.point.clone()));
    } else {
      this.onPick(hit ? this.bodyOf(hit.object) : null);
    }
  }

  private addPoint(point: Vector3): void {
    if (this.points.length === 2) this.points = [];
    this.points.push(point);
    this.drawMarks();
    this.onMeasure(this.points);
  }

  private drawMarks(): void {
    for (const mark of [...this.marks.children] as (Mesh | Line)[]) {
      mark.geometry.dispose();
      this.marks.remove(mark);
    }
    const eye = this.view.base.worldToLocal(this.view.camera.position.clone());
    for (const point of this.points) {
      const sphere = new SphereGeometry(markAngle * eye.distanceTo(point), 12, 8);
      const mark = new Mesh(sphere, new MeshBasicMaterial({ color: markColor, depthTest: false }));
      mark.position.copy(point);
      mark.renderOrder = 3;
      this.marks.add(mark);
    }
    if (this.points.length === 2) {
      const material = new LineBasicMaterial({ color: markColor, depthTest: false });
      const line = new Line(new BufferGeometry().setFromPoints(this.points), material);
      line.renderOrder = 3;
      this.marks.add(line);
    }
    this.invalidate();
  }

  private bodyOf(object: Object3D): Body | null {
    for (let node: Object3D | null = object; node; node = node.parent) {
      const body = this.view.bodies.find((b) => b.solid === node);
      if (body) return body;
    }
    return null;
  }
}
