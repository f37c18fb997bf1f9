// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight,
  Box3,
  Color,
  DirectionalLight,
  Group,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
} from 'three';
import type { LiveState, Vector } from '../protocol';
import { Body } from './bodies';
import { Layers } from './layers';
import type { Outline } from './outline';
import { PlumbLine } from './plumb_line';
import type { SceneModel } from './scene_model';
import { ToolView } from './tool_view';

const viewingElevation = 0.6; // [rad] shows a table top and the bodies on it
const minRadius = 0.15; // [m]
const backgrounds = { light: '#e9edf1', dark: '#15191e' };

/// The scene graph. three.js has y up, the base frame z up: the group `base` converts, and
/// everything in the robot's base frame is its child.
export class SceneView {
  readonly scene = new Scene();
  readonly base = new Group();
  readonly camera = new PerspectiveCamera(50, 1, 0.02, 60);
  readonly layers: Layers;
  readonly tool: ToolView;
  bodies: Body[] = [];
  model: SceneModel | null = null;
  private readonly plumbLine: PlumbLine;
  private supports: Outline[] = [];
  private byName = new Map<string, Body>();
  private order: (Body | undefined)[] = []; // in the order of the server's state

  constructor() {
    this.base.name = 'base';
    this.base.rotation.x = -Math.PI / 2;
    this.scene.add(this.base);
    this.layers = new Layers(this.base);
    this.tool = new ToolView(this.base);
    this.plumbLine = new PlumbLine(this.tool.group);
    this.addLights();
  }

  setModel(model: SceneModel): void {
    this.model = model;
    this.supports = model.support_planes.map(({ outline }) => outline);
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

  /// `names`: of the state's objects, in its order.
  setObjectOrder(names: readonly string[]): void {
    this.order = names.map((name) => this.byName.get(name));
  }

  showState(state: LiveState): void {
    state.objects.forEach((object, i) => {
      const body = this.order[i];
      body?.place(object.position, object.quaternion);
      body?.setPhase(object.phase, object.isOutsideModel);
    });
    this.tool.showContact(state);
    this.showTool(state.proxy, state.hip, state.force);
  }

  showTool(proxy: Readonly<Vector>, hip: Readonly<Vector>, force: Readonly<Vector>): void {
    this.tool.show(proxy, hip, force);
    this.plumbLine.show(proxy, this.tool.radius, this.bodies, this.supports);
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.scene.background = new Color(backgrounds[theme]);
  }

  /// Frames the movable bodies from the side of the scan's first camera, where the scan has the
  /// fewest holes; without movable bodies, from that camera's pose. Returns the target point.
  frameAll(): Vector3 {
    this.scene.updateMatrixWorld(true);
    const box = this.boundsToFrame();
    const center = box.getCenter(new Vector3());
    const first = this.model?.cameras[0];
    if (first && !this.bodies.some((body) => body.object.movable))
      return this.lookAsCamera(first, center);
    const radius = Math.max(0.5 * box.getSize(new Vector3()).length(), minRadius);
    const aspect = Math.min(1, this.camera.aspect);
    const distance = radius / (aspect * Math.sin((this.camera.fov * Math.PI) / 360));
    this.camera.position.copy(center).addScaledVector(this.viewDirection(center), distance);
    this.camera.lookAt(center);
    return center;
  }

  /// A camera looks along its z. The target's distance is that of `center`.
  private lookAsCamera(camera: SceneModel['cameras'][number], center: Vector3): Vector3 {
    const eye = this.base.localToWorld(new Vector3(...camera.position));
    const forward = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(...camera.quaternion));
    forward.transformDirection(this.base.matrixWorld);
    const target = eye
      .clone()
      .addScaledVector(forward, Math.max(eye.distanceTo(center), minRadius));
    this.camera.position.copy(eye);
    this.camera.lookAt(target);
    return target;
  }

  /// The bounding box of the movable bodies with a margin, or else of everything.
  private boundsToFrame(): Box3 {
    const box = new Box3();
    for (const body of this.bodies) if (body.object.movable) box.expandByObject(body.solid);
    if (!box.isEmpty()) return box.expandByScalar(0.1);
    for (const name of ['bodies', 'mesh'] as const) box.expandByObject(this.layers.group(name));
    return box.isEmpty() ? box.set(new Vector3(-1, 0, -1), new Vector3(1, 1, 1)) : box;
  }

  /// Unit vector from the center to the viewpoint: towards the first camera, at a fixed elevation;
  /// without a camera from behind the robot's base, along its x.
  private viewDirection(center: Vector3): Vector3 {
    const camera = this.model?.cameras[0];
    const side = camera
      ? this.base.localToWorld(new Vector3(...camera.position)).sub(center)
      : new Vector3(-1, 0, 0.5);
    const level = side.setY(0).length() > 1e-3 ? side.normalize() : new Vector3(-1, 0, 0);
    return level.setY(Math.tan(viewingElevation)).normalize();
  }

  /// Ambient light, a directional light, and one at the camera for shading.
  private addLights(): void {
    this.scene.add(new AmbientLight('#ffffff', 1.9));
    const keyLight = new DirectionalLight('#ffffff', 1.1);
    keyLight.position.set(-1, 3, 2);
    this.scene.add(keyLight);
    const headlight = new DirectionalLight('#ffffff', 0.6);
    this.camera.add(headlight);
    this.scene.add(this.camera);
  }
}
