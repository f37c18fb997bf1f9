// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight,
  Box3,
  Color,
  DirectionalLight,
  Group,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  Quaternion,
  Scene,
  SphereGeometry,
  Vector3,
} from 'three';
import { sourceColors } from '../palette';
import type { LiveState, Vector } from '../protocol';
import { ArmView } from './arm';
import { Body } from './bodies';
import { ContactShadows } from './contact_shadow';
import { cornersOf } from './box';
import { framePoints, operatorSide } from './first_view';
import { Layers } from './layers';
import type { Outline } from './outline';
import { PlumbLine } from './plumb_line';
import { makeRobotGlyph } from './robot_glyph';
import { hasRobotBase, type SceneModel } from './scene_model';
import { ToolView } from './tool_view';

// [rad] shows a table top and the bodies on it; steeper in a tall window, which it fills better.
const topElevation = 1.55; // [rad] not quite a right angle: up in the picture is away from the operator
const frontElevation = 0.05; // [rad] the support is still seen
const viewingElevation = { wide: 0.6, tall: 0.95 };
const minRadius = 0.15; // [m]
const frameMargin = 0.86; // share of the window that is filled: labels and statistics need the rest
const bodyMargin = 0.06; // [m]
const supportReach = 0.8; // [m] around the bodies: a larger table would make them small
const besideArm = 1.1; // [rad] around the vertical
const backgrounds = { light: '#e9edf1', dark: '#15191e' };

/// The scene graph. three.js has y up, the base frame z, or the scene's `up`: the group `base`
/// converts, and everything in the robot's base frame is its child.
/// Where the scene is looked at from: `camera` is the pose of the recording's first picture.
export type ViewSide = 'operator' | 'top' | 'front' | 'camera';

export class SceneView {
  readonly scene = new Scene();
  readonly base = new Group();
  readonly camera = new PerspectiveCamera(50, 1, 0.02, 60);
  readonly layers: Layers;
  readonly tool: ToolView;
  bodies: Body[] = [];
  arm: ArmView | null = null;
  model: SceneModel | null = null;
  private readonly robotTip = new Mesh(
    new SphereGeometry(1, 20, 12),
    new MeshBasicMaterial({ color: sourceColors.tracked, transparent: true, opacity: 0.6 }),
  );
  private readonly plumbLine: PlumbLine;
  private readonly shadows: ContactShadows;
  private supports: Outline[] = [];
  private byName = new Map<string, Body>();
  private order: (Body | undefined)[] = []; // in the order of the server's state

  constructor() {
    this.base.name = 'base';
    this.base.rotation.x = -Math.PI / 2;
    this.scene.add(this.base);
    this.layers = new Layers(this.base);
    this.tool = new ToolView(this.base);
    this.robotTip.visible = false;
    this.layers.group('ghosts').add(this.robotTip);
    this.plumbLine = new PlumbLine(this.tool.group);
    this.shadows = new ContactShadows(this.layers.group('bodies'), this.tool.group);
    this.scene.onBeforeRender = () => this.showShadows();
    this.addLights();
  }

  private showShadows(): void {
    const { group, proxy, radius } = this.tool;
    const tool = group.visible ? { position: proxy.position.toArray(), radius } : null;
    this.shadows.show(this.bodies, tool, this.supports);
  }

  setModel(model: SceneModel): void {
    this.model = model;
    this.base.quaternion.setFromUnitVectors(new Vector3(...model.up), new Vector3(0, 1, 0));
    this.supports = model.support_planes.map(({ outline }) => outline);
    let movable = 0;
    this.bodies = model.objects.map((o) => new Body(o, o.movable ? movable++ : 0));
    if (model.robot) {
      this.arm = new ArmView(model.robot);
      this.layers.group('arm').add(this.arm.group);
    }
    if (hasRobotBase(model)) this.layers.group('arm').add(this.placeRobotGlyph());
    for (const body of this.bodies) {
      this.byName.set(body.object.name, body);
      this.layers.group('bodies').add(body.solid);
      this.layers.group('ghosts').add(body.ghost);
    }
  }

  /// At the arm's root, or without an arm at the base frame's origin.
  private placeRobotGlyph(): Group {
    const glyph = makeRobotGlyph();
    if (!this.arm) return glyph;
    glyph.position.copy(this.arm.group.position);
    glyph.quaternion.copy(this.arm.group.quaternion);
    return glyph;
  }

  body(name: string): Body | undefined {
    return this.byName.get(name);
  }

  /// `names`: of the state's objects, in its order.
  setObjectOrder(names: readonly string[]): void {
    this.order = names.map((name) => this.byName.get(name));
  }

  /// Without a server phases and forces are not known; the poses stay where they were.
  forgetState(): void {
    for (const body of this.bodies) {
      body.isKnown = false;
      body.ghost.visible = false;
    }
    this.robotTip.visible = false;
    this.tool.forgetForce();
  }

  showState(state: LiveState): void {
    for (const body of this.bodies) body.isKnown = true;
    state.objects.forEach((object, i) => {
      const body = this.order[i];
      body?.place(object.position, object.quaternion);
      body?.setPhase(object.phase, object.isOutsideModel);
      body?.setContact(object.isBlocked, object.isSaturated);
    });
    this.showMeasured(state);
    if (state.arm) this.arm?.show(state.arm.position);
    this.arm?.setStopped(state.arm?.isStopped ?? false);
    this.tool.showContact(state);
    this.showTool(state.proxy, state.hip, state.force);
  }

  /// At an operator's site: where the robot's site has the objects and its tip.
  private showMeasured({ link }: LiveState): void {
    const robot = link?.robot;
    this.robotTip.visible = robot !== null && robot !== undefined;
    if (!robot) return;
    this.robotTip.position.fromArray(robot.tip);
    this.robotTip.scale.setScalar(this.tool.radius);
    robot.objects.forEach(({ position, quaternion, isTracked }, i) => {
      const body = this.order[i];
      if (isTracked) body?.placeGhost(position, quaternion);
      else if (body) body.ghost.visible = false;
    });
  }

  showTool(proxy: Readonly<Vector>, hip: Readonly<Vector>, force: Readonly<Vector>): void {
    this.tool.show(proxy, hip, force);
    this.plumbLine.show(proxy, this.tool.radius, this.bodies, this.supports);
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.scene.background = new Color(backgrounds[theme]);
  }

  /// Shows all movable bodies, the supports they stand on and the tool, from where the operator
  /// stands, as large as the window's shape allows; without movable bodies, from the first camera's
  /// pose. `from`: another side. Returns the target point.
  frameAll(from: ViewSide = 'operator'): Vector3 {
    this.scene.updateMatrixWorld(true);
    const box = this.boundsToFrame();
    const center = box.getCenter(new Vector3());
    const first = this.model?.cameras[0];
    const isCameras = from === 'operator' && !this.bodies.some((body) => body.object.movable);
    if (first && (isCameras || from === 'camera')) return this.lookAsCamera(first, center);
    const up = frameMargin * Math.tan((this.camera.fov * Math.PI) / 360);
    const tangents = { right: up * this.camera.aspect, up };
    const points = this.pointsToFrame(box);
    const { eye, target } = framePoints(points, this.viewDirection(center, from), tangents);
    this.camera.position.copy(eye);
    this.camera.lookAt(target);
    return target;
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
    if (!box.isEmpty()) return box.expandByScalar(bodyMargin);
    for (const name of ['bodies', 'mesh'] as const) box.expandByObject(this.layers.group(name));
    return box.isEmpty() ? box.set(new Vector3(-1, 0, -1), new Vector3(1, 1, 1)) : box;
  }

  /// The corners of the bodies' box, of the supports below them as far as they are near, and the
  /// tool; all in the scene's coordinates.
  private pointsToFrame(box: Box3): Vector3[] {
    const points = cornersOf(box);
    const near = box.clone().expandByVector(new Vector3(supportReach, 0, supportReach));
    near.min.y = -Infinity;
    for (const corner of this.supports.flat()) {
      const point = this.base.localToWorld(new Vector3(...corner));
      if (point.y < box.max.y) points.push(point.clamp(near.min, near.max));
    }
    if (this.arm) points.push(...cornersOf(new Box3().setFromObject(this.arm.group)));
    const { tool } = this;
    if (tool.group.visible) points.push(tool.proxy.getWorldPosition(new Vector3()));
    return points;
  }

  /// Unit vector from the center to the viewpoint: towards the operator, at a fixed elevation, from
  /// above, or level with the bodies.
  private viewDirection(center: Vector3, from: ViewSide): Vector3 {
    const cameras = this.model?.cameras.map(({ position }) => position) ?? [];
    const at = this.base.worldToLocal(center.clone()).toArray();
    const side = operatorSide(at, cameras).transformDirection(this.base.matrixWorld);
    // An arm stands between the operator's place and the bodies: seen from beside it.
    if (this.arm) side.applyAxisAngle(new Vector3(0, 1, 0), besideArm);
    const elevation = viewingElevation[this.camera.aspect < 1 ? 'tall' : 'wide'];
    const angle = from === 'top' ? topElevation : from === 'front' ? frontElevation : elevation;
    return side.setY(Math.tan(angle)).normalize();
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
