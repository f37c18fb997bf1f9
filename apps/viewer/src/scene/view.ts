// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight,
  Box3,
  Color,
  DirectionalLight,
  Group,
  PerspectiveCamera,
  Scene,
  Vector3,
} from 'three';
import type { LiveState } from '../protocol';
import { Body } from './bodies';
import { Layers } from './layers';
import type { SceneModel } from './scene_model';
import { ToolView } from './tool_view';

const backgrounds = { light: '#e9edf1', dark: '#15191e' };

/// The drawn world. three.js has y up, the base frame z: `base` stands between them, and whatever
/// is in the robot's base frame hangs below it.
export class SceneView {
  readonly scene = new Scene();
  readonly base = new Group();
  readonly camera = new PerspectiveCamera(50, 1, 0.02, 60);
  readonly layers: Layers;
  readonly tool: ToolView;
  bodies: Body[] = [];
  model: SceneModel | null = null;
  private byName = new Map<string, Body>();
  private order: (Body | undefined)[] = []; // as the server's state has them

  constructor() {
    this.base.name = 'base';
    this.base.rotation.x = -Math.PI / 2;
    this.scene.add(this.base);
    this.layers = new Layers(this.base);
    this.tool = new ToolView(this.base);
    this.addLights();
  }

  setModel(model: SceneModel): void {
    this.model = model;
    let movable = 0;
    this.bodies = model.objects.map((o) => new Body(o, o.movable ? movable++ : 0));
    for (const body of this.bodies) {
      this.byName.set(body.object.name, body);
      this.layers.group('bodies').add(body.solid);
      this.layers.group('ghosts').add(body.ghost);
    }
  }

  body(name: string): Body | undefined {
    return this.byName.get(name);
  }

  /// The names of a state's objects, in its order.
  setObjectOrder(names: readonly string[]): void {
    this.order = names.map((name) => this.byName.get(name));
  }

  showState(state: LiveState): void {
    state.objects.forEach((object, i) => {
      const body = this.order[i];
      body?.place(object.position, object.quaternion);
      body?.setPhase(object.phase, object.isOutsideModel);
    });
    this.tool.showState(state);
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.scene.background = new Color(backgrounds[theme]);
  }

  /// Looks at everything from the operator's side: behind the robot's base, a little from above.
  frameAll(): Vector3 {
    this.scene.updateMatrixWorld(true);
    const box = new Box3();
    for (const name of ['mesh', 'bodies'] as const) box.expandByObject(this.layers.group(name));
    if (box.isEmpty()) box.set(new Vector3(-0.5, 0, -0.5), new Vector3(0.5, 0.5, 0.5));
    const center = this.interest(box);
    const size = box.getSize(new Vector3()).length();
    const distance = (0.55 * size) / Math.tan((this.camera.fov * Math.PI) / 360);
    // x of base runs away from the robot: from behind it, and from its right.
    const direction = new Vector3(-0.62, 0.62, 0.5).normalize();
    this.camera.position.copy(center).addScaledVector(direction, Math.min(distance, 6));
    this.camera.lookAt(center);
    return center;
  }

  /// What there is to push, or else the middle of it all.
  private interest(all: Box3): Vector3 {
    const box = new Box3();
    for (const body of this.bodies) if (body.object.movable) box.expandByObject(body.solid);
    return (box.isEmpty() ? all : box).getCenter(new Vector3());
  }

  /// Scans bring their own light and shadow: mostly even light, and some from the eye for shape.
  private addLights(): void {
    this.scene.add(new AmbientLight('#ffffff', 1.9));
    const sun = new DirectionalLight('#ffffff', 1.1);
    sun.position.set(-1, 3, 2);
    this.scene.add(sun);
    const lamp = new DirectionalLight('#ffffff', 0.6);
    this.camera.add(lamp);
    this.scene.add(this.camera);
  }
}
