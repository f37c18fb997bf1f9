// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3, type PerspectiveCamera } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { HeldKeys } from './keys';

const walkSpeed = 0.8; // [m/s] a slow walk: a scene is a table and what is around it
const turnSpeed = 1; // [rad/s]
const lookDistance = 0.05; // [m] turning about a point so near is turning on the spot

/// Moving the eye: orbit about a point, or look around from where one stands; W A S D walks, I J K L
/// turns.
export class Navigation {
  readonly controls: OrbitControls;
  mode: 'orbit' | 'walk' = 'orbit';
  hasMoved = false; // by the user's hand
  private readonly keys: HeldKeys;

  constructor(
    private readonly camera: PerspectiveCamera,
    canvas: HTMLCanvasElement,
    onChange: () => void,
  ) {
    this.controls = new OrbitControls(camera, canvas);
    this.controls.minDistance = 0.02;
    this.controls.maxDistance = 30;
    this.controls.addEventListener('change', onChange);
    this.controls.addEventListener('start', () => (this.hasMoved = true));
    this.keys = new HeldKeys(
      [canvas],
      [...'WASDQEIJKL'].map((letter) => `Key${letter}`),
    );
  }

  lookAt(target: Vector3): void {
    this.controls.target.copy(target);
    this.setMode(this.mode);
    this.controls.update();
  }

  setMode(mode: 'orbit' | 'walk'): void {
    const wasWalk = this.mode === 'walk';
    this.mode = mode;
    const isWalk = mode === 'walk';
    this.controls.enableZoom = !isWalk;
    this.controls.rotateSpeed = isWalk ? -0.4 : 1;
    if (isWalk === wasWalk) return;
    const ahead = this.camera.getWorldDirection(new Vector3());
    this.controls.target
      .copy(this.camera.position)
      .addScaledVector(ahead, isWalk ? lookDistance : 1);
    this.controls.update();
  }

  /// `seconds` since the frame before.
  update(seconds: number): void {
    this.walk(seconds);
    this.turn(seconds);
  }

  private turn(seconds: number): void {
    const left = this.keys.axis('KeyJ', 'KeyL');
    const up = this.keys.axis('KeyI', 'KeyK');
    if (left === 0 && up === 0) return;
    this.hasMoved = true;
    // Looking round turns the view as orbiting turns the scene: the other way about.
    const angle = (this.mode === 'walk' ? -turnSpeed : turnSpeed) * seconds;
    this.controls.rotateLeft(left * angle);
    this.controls.rotateUp(up * angle);
  }

  private walk(seconds: number): void {
    const ahead = this.keys.axis('KeyW', 'KeyS');
    const aside = this.keys.axis('KeyD', 'KeyA');
    const up = this.keys.axis('KeyE', 'KeyQ');
    if (ahead === 0 && aside === 0 && up === 0) return;
    this.hasMoved = true;
    const forward = levelDirection(this.camera);
    const right = new Vector3(-forward.z, 0, forward.x);
    const step = forward
      .multiplyScalar(ahead)
      .addScaledVector(right, aside)
      .add(new Vector3(0, up, 0))
      .normalize()
      .multiplyScalar(walkSpeed * seconds);
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
  }
}

/// Where the camera looks, without up and down.
export function levelDirection(camera: PerspectiveCamera): Vector3 {
  const direction = camera.getWorldDirection(new Vector3());
  // Straight down, what is up in the picture is ahead.
  if (Math.hypot(direction.x, direction.z) < 1e-3)
    direction.set(0, 1, 0).applyQuaternion(camera.quaternion);
  return direction.setY(0).normalize();
}
