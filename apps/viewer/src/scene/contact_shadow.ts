// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Box3, type Group, Mesh, PlaneGeometry, ShaderMaterial, Vector2, Vector3 } from 'three';
import type { Vector } from '../protocol';
import type { Body } from './bodies';
import type { Outline } from './outline';
import { supportBelow } from './plumb_line';

const lift = 0.002; // [m] above the support: less than a body's edge, more than a scan's noise
const minBlur = 0.025; // [m] of a body that stands on its support
const blurPerHeight = 0.6; // a soft light from above
const maxHeight = 0.4; // [m] beyond, the shadow is too faint to be seen
const strength = 0.5;

const vertexShader = `
varying vec2 at;
uniform vec2 size;
void main() {
  at = position.xy * size;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 0.0, 1.0);
}`;
// The distance to the footprint, a rectangle, decides how dark it is.
const fragmentShader = `
varying vec2 at;
uniform vec2 half_size;
uniform float blur;
uniform float darkness;
void main() {
  float outside = length(max(abs(at) - half_size, 0.0));
  float share = 1.0 - smoothstep(0.0, blur, outside);
  gl_FragColor = vec4(0.0, 0.0, 0.0, darkness * share * share);
}`;

/// What casts a shadow, in base: a level rectangle and the height of its underside.
export interface Footprint {
  center: Vector2;
  heading: number; // [rad]
  half: Vector2; // [m]
  bottom: number; // [m]
}

/// The level rectangle around a box [m, in the body's axes] at a pose, along the body's heading.
export function footprintOf(box: Box3, body: Pick<Body, 'solid'>): Footprint {
  const { position, quaternion } = body.solid;
  const axis = new Vector3(1, 0, 0).applyQuaternion(quaternion);
  // An x axis that is nearly vertical has no heading.
  if (Math.abs(axis.z) > 0.87) axis.set(0, 1, 0).applyQuaternion(quaternion);
  const heading = Math.atan2(axis.y, axis.x);
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = low.clone().negate();
  const corner = new Vector3();
  for (let i = 0; i < 8; ++i) {
    corner.set(
      i & 1 ? box.max.x : box.min.x,
      i & 2 ? box.max.y : box.min.y,
      i & 4 ? box.max.z : box.min.z,
    );
    corner.applyQuaternion(quaternion).add(position);
    corner.applyAxisAngle(new Vector3(0, 0, 1), -heading);
    low.min(corner);
    high.max(corner);
  }
  const middle = low.clone().add(high).multiplyScalar(0.5);
  middle.applyAxisAngle(new Vector3(0, 0, 1), heading);
  return {
    center: new Vector2(middle.x, middle.y),
    heading,
    half: new Vector2(0.5 * (high.x - low.x), 0.5 * (high.y - low.y)),
    bottom: low.z,
  };
}

/// A soft shadow on the support below a body or the tool: one quad, no render pass of its own.
class ContactShadow {
  readonly mesh: Mesh;
  private readonly uniforms = {
    size: { value: new Vector2() },
    half_size: { value: new Vector2() },
    blur: { value: minBlur },
    darkness: { value: 0 },
  };

  constructor(group: Group) {
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      uniforms: this.uniforms,
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -2,
      polygonOffsetUnits: -2,
    });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.name = 'contact shadow';
    this.mesh.frustumCulled = false; // its size is in the shader
    this.mesh.raycast = () => {}; // it is not to be picked
    group.add(this.mesh);
  }

  show({ center, heading, half, bottom }: Footprint, support: number): void {
    const height = Math.max(bottom - support, 0);
    this.mesh.visible = Number.isFinite(support) && height < maxHeight;
    if (!this.mesh.visible) return;
    const blur = minBlur + blurPerHeight * height;
    this.uniforms.half_size.value.copy(half);
    this.uniforms.size.value.copy(half).addScalar(blur).multiplyScalar(2);
    this.uniforms.blur.value = blur;
    this.uniforms.darkness.value = strength * (1 - height / maxHeight);
    this.mesh.position.set(center.x, center.y, support + lift);
    this.mesh.rotation.z = heading;
    this.mesh.updateMatrixWorld();
  }

  hide(): void {
    this.mesh.visible = false;
  }
}

/// The shadows of all bodies and of the tool, all in base.
export class ContactShadows {
  private readonly shadows = new Map<Body, { shadow: ContactShadow; box: Box3 | null }>();
  private readonly ofTool: ContactShadow;

  constructor(
    private readonly group: Group,
    toolGroup: Group,
  ) {
    this.ofTool = new ContactShadow(toolGroup);
    this.ofTool.hide();
  }

  /// `tool`: null where it is not shown. Call before each picture.
  show(
    bodies: readonly Body[],
    tool: { position: Readonly<Vector>; radius: number } | null,
    supports: readonly Outline[],
  ): void {
    for (const body of bodies) this.showBody(body, supports);
    if (!tool) return this.ofTool.hide();
    const [x, y, z] = tool.position;
    const footprint = {
      center: new Vector2(x, y),
      heading: 0,
      half: new Vector2(0.3 * tool.radius, 0.3 * tool.radius),
      bottom: z - tool.radius,
    };
    this.ofTool.show(footprint, supportBelow(tool.position, supports));
  }

  private showBody(body: Body, supports: readonly Outline[]): void {
    let known = this.shadows.get(body);
    if (!known) {
      known = { shadow: new ContactShadow(this.group), box: null };
      this.shadows.set(body, known);
    }
    known.box ??= localBox(body); // its parts are loaded later than the body
    if (!known.box || !body.solid.visible) return known.shadow.hide();
    const footprint = footprintOf(known.box, body);
    const { x, y } = footprint.center;
    const middle: Vector = [x, y, body.solid.position.z];
    known.shadow.show(footprint, supportBelow(middle, supports));
  }
}

/// The bounding box in the body's own axes; null before its parts are loaded.
function localBox(body: Body): Box3 | null {
  const box = new Box3();
  for (const child of body.solid.children) {
    if (!(child instanceof Mesh)) continue;
    const geometry = child.geometry as Mesh['geometry'];
    geometry.computeBoundingBox();
    if (geometry.boundingBox) box.union(geometry.boundingBox.clone().applyMatrix4(child.matrix));
  }
  return box.isEmpty() ? null : box;
}
