// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { SceneView } from '../scene/view';
import { byId, create, setText } from './dom';
import { project } from './labels';

/// What is measured, in the scene: the ends with their coordinates, and between them the distance
/// with its components, all in base.
export class MeasureLabels {
  private readonly labels = [0, 1, 2].map(() => create('span', { className: 'measure' }));

  constructor(
    private readonly view: SceneView,
    private readonly stage: HTMLElement,
  ) {
    byId('labels', HTMLDivElement).append(...this.labels);
  }

  /// `points`: none, one or two, in base [m].
  update(points: readonly Vector3[]): void {
    const [a, b] = points;
    this.place(0, a, a && `A ${coordinates(a)}`);
    this.place(1, b, b && `B ${coordinates(b)}`);
    const middle = a && b && a.clone().lerp(b, 0.5);
    this.place(2, middle, middle && differenceText(a, b));
  }

  private place(index: number, point: Vector3 | undefined, text: string | undefined): void {
    const label = this.labels[index];
    const { clientWidth, clientHeight } = this.stage;
    const world = point && this.view.base.localToWorld(point.clone());
    const at = world && project(world, this.view.camera, clientWidth, clientHeight);
    label.hidden = !at;
    if (!at || text === undefined) return;
    setText(label, text);
    label.style.transform = `translate(${at.x.toFixed(0)}px, ${at.y.toFixed(0)}px) translate(-50%, ${index < 2 ? '8px' : 'calc(-100% - 8px)'})`;
  }
}

function millimetresOf(metres: number): string {
  return (metres * 1e3).toFixed(1);
}

function coordinates({ x, y, z }: Vector3): string {
  return `(${[x, y, z].map(millimetresOf).join(', ')}) mm`;
}

/// The distance from a to b with its components along base's axes.
export function differenceText(a: Vector3, b: Vector3): string {
  const { x, y, z } = b.clone().sub(a);
  const [dx, dy, dz] = [x, y, z].map(millimetresOf);
  return `${millimetresOf(a.distanceTo(b))} mm: Δx ${dx}, Δy ${dy}, Δz ${dz}`;
}
