// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  Box3,
  Color,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  type Object3D,
  type Texture,
} from 'three';
import { fixedColor, objectColors, phaseColors, sourceColors } from '../palette';
import type { Phase, Quaternion, Vector } from '../protocol';
import { outlineMesh } from './body_outline';
import type { GlbPart } from './glb';
import type { SceneObject } from './scene_model';
import { seeThrough } from './see_through';

const outsideColor = '#c92a2a';
const restColor = '#10151b'; // of the edges of a painted body that is free
const edgeAngle = 25; // [degrees] between faces: a rounded edge of a CAD body shows no lines

export function bodyColor(index: number, movable: boolean): string {
  return movable ? objectColors[index % objectColors.length] : fixedColor;
}

/// Polygon offset: the faces are drawn slightly behind the edges, against z-fighting.
const behindEdges = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };

/// A CAD body: solid at its predicted pose, with a ghost at its tracked pose. One with a texture looks as
/// recorded and has an outline of its colour; others are painted in it.
export class Body {
  readonly solid = new Group();
  readonly ghost = new Group();
  readonly color: string;
  readonly marks = [new Group(), new Group()] as const; // its tags, its frame: in separate layers
  phase: Phase = 'free';
  isOutsideModel = false;
  isBlocked = false;
  isSaturated = false;
  isKnown = true; // false: without a server, phase and force are not
  private fill: MeshLambertMaterial | MeshBasicMaterial;
  private readonly edges = new LineBasicMaterial({ color: restColor });
  private readonly outline: MeshBasicMaterial;
  private hasTexture = false;
  private readonly ownBox = new Box3(); // in its frame; empty until the mesh is loaded

  constructor(
    readonly object: SceneObject,
    index: number,
  ) {
    this.color = bodyColor(index, object.movable);
    this.fill = seeThrough(new MeshLambertMaterial({ color: this.color, ...behindEdges }));
    this.outline = new MeshBasicMaterial({ color: this.color });
    this.solid.name = object.name;
    this.ghost.name = `${object.name} (tracked)`;
    this.ghost.visible = false;
    this.place(object.position, object.quaternion);
  }

  /// `map`: the recorded colours, which contain the light.
  addParts(parts: readonly GlbPart[], map: Texture | null = null): void {
    if (map !== null) {
      this.hasTexture = true;
      this.fill = seeThrough(new MeshBasicMaterial({ map, ...behindEdges }));
      this.paintState();
    }
    const ghostFill = new MeshLambertMaterial({
      color: sourceColors.tracked,
      transparent: true,
      opacity: 0.14,
      depthWrite: false,
    });
    const ghostEdges = new LineBasicMaterial({ color: sourceColors.tracked });
    for (const { geometry, matrix } of parts) {
      const edges = new EdgesGeometry(geometry, edgeAngle);
      this.add(this.solid, new Mesh(geometry, this.fill), matrix);
      geometry.computeBoundingBox();
      this.ownBox.union(geometry.boundingBox!.clone().applyMatrix4(matrix));
      this.add(this.solid, new LineSegments(edges, this.edges), matrix);
      if (map !== null) this.add(this.solid, outlineMesh(geometry, this.outline), matrix);
      this.add(this.ghost, new Mesh(geometry, ghostFill), matrix);
      this.add(this.ghost, new LineSegments(edges, ghostEdges), matrix);
    }
  }

  place(position: Readonly<Vector>, quaternion: Readonly<Quaternion>): void {
    for (const group of [this.solid, ...this.marks]) {
      group.position.fromArray(position);
      group.quaternion.fromArray(quaternion);
    }
  }

  /// Its bounds in its own frame; empty until the mesh is loaded.
  get box(): Box3 {
    return this.ownBox.clone();
  }

  /// Its bounds in base; empty until the mesh is loaded.
  get boxInBase(): Box3 {
    this.solid.updateMatrix();
    return this.ownBox.isEmpty() ? this.box : this.box.applyMatrix4(this.solid.matrix);
  }

  placeGhost(position: Readonly<Vector>, quaternion: Readonly<Quaternion>): void {
    this.ghost.position.fromArray(position);
    this.ghost.quaternion.fromArray(quaternion);
    this.ghost.visible = true;
  }

  setContact(isBlocked: boolean, isSaturated: boolean): void {
    this.isBlocked = isBlocked;
    this.isSaturated = isSaturated;
  }

  setPhase(phase: Phase, isOutsideModel: boolean): void {
    if (phase === this.phase && isOutsideModel === this.isOutsideModel) return;
    this.phase = phase;
    this.isOutsideModel = isOutsideModel;
    this.paintState();
  }

  private paintState(): void {
    const { phase, isOutsideModel } = this;
    const free = this.hasTexture ? this.color : restColor;
    this.edges.color = new Color(
      isOutsideModel ? outsideColor : phase === 'free' ? free : phaseColors[phase],
    );
    this.fill.transparent = isOutsideModel;
    this.fill.opacity = isOutsideModel ? 0.4 : 1;
    this.fill.needsUpdate = true;
  }

  private add(group: Group, child: Object3D, matrix: GlbPart['matrix']): void {
    child.matrixAutoUpdate = false;
    child.matrix.copy(matrix);
    group.add(child);
  }
}
