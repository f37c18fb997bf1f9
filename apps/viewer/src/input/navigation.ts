// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3, type PerspectiveCamera } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { HeldKeys } from './keys';

const walkSpeed = 0.8; // [m/s] a slow walk: a scene is a table and its surroundings
const turnSpeed = 1; // [rad/s]
const lookDistance = 0.05; // [m] orbiting about so near a point turns the camera in place

/// Camera navigation: orbit about a point, or look around in walk mode; W A S D walks, I J K L
/// turns.
export class Navigation {
  readonly controls: OrbitControls;
  mode: 'orbit' | 'walk' = 'orbit';
  hasMoved = false; // by the user
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

  /// As if the user had moved the camera there.
  place(eye: Vector3, target: Vector3): void {
    this.hasMoved = true;
    this.camera.position.copy(eye);
    this.lookAt(target);
  }

  /// Moves the camera without turning it, as if the user had.
  shift(step: Vector3): void {
    this.hasMoved = true;
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
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
    const forward = this.camera.getWorldDirection(new Vector3());
    this.controls.target
      .copy(this.camera.position)
      .addScaledVector(forward, isWalk ? lookDistance : 1);
    this.controls.update();
  }

  /// `seconds` since the previous frame.
  update(seconds: number): void {
    this.walk(seconds);
    this.turn(seconds);
  }

  private turn(seconds: number): void {
    const left = this.keys.axis('KeyJ', 'KeyL');
    const up = this.keys.axis('KeyI', 'KeyK');
    if (left === 0 && up === 0) return;
    this.hasMoved = true;
    // Walk mode turns the camera, orbit mode the scene: opposite signs.
    const angle = (this.mode === 'walk' ? -turnSpeed : turnSpeed) * seconds;
    this.controls.rotateLeft(left * angle);
    this.controls.rotateUp(up * angle);
  }

  private walk(seconds: number): void {
    const forwardKeys = this.keys.axis('KeyW', 'KeyS');
    const rightKeys = this.keys.axis('KeyD', 'KeyA');
    const upKeys = this.keys.axis('KeyE', 'KeyQ');
    if (forwardKeys === 0 && rightKeys === 0 && upKeys === 0) return;
    const forward = horizontalDirection(this.camera);
    const right = new Vector3(-forward.z, 0, forward.x);
    const step = forward
      .multiplyScalar(forwardKeys)
      .addScaledVector(right, rightKeys)
      .add(new Vector3(0, upKeys, 0))
      .normalize()
      .multiplyScalar(walkSpeed * seconds);
    this.shift(step);
  }
}

/// The camera's viewing direction projected on the horizontal plane.
export function horizontalDirection(camera: PerspectiveCamera): Vector3 {
  const direction = camera.getWorldDirection(new Vector3());
  // Looking straight down, the image's up direction counts as forward.
  if (Math.hypot(direction.x, direction.z) < 1e-3)
    direction.set(0, 1, 0).applyQuaternion(camera.quaternion);
  return direction.setY(0).normalize();
}
