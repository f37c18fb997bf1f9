// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3, type Material } from 'three';

// Shared by all materials: the tool's centre in the scene's coordinates, its radius [m] (0: no
// tool is shown).
const tool = { center: { value: new Vector3() }, radius: { value: 0 } };

export function showThrough(center: Vector3, radius: number): void {
  tool.center.value.copy(center);
  tool.radius.value = radius;
}

const clearRadii = 3.5; // of the tool: the hole shows the ring around the tool as well

// The direction and the distance of the tool from the eye are the same for all fragments.
const vertexDeclarations = /* glsl */ `
varying vec3 vAtEye;
flat varying vec4 vTool;
uniform vec3 toolCenter;
uniform float toolRadius;
`;
const vertexCode = /* glsl */ `
#include <project_vertex>
vAtEye = mvPosition.xyz;
vec3 toTool = (viewMatrix * vec4(toolCenter, 1.0)).xyz;
vTool = vec4(normalize(toTool), length(toTool));
`;

// Screen-door transparency: of what is nearer than the tool, in a cone from the eye around it, one
// pixel of four is drawn. It needs no sorting and works with any material.
const fragmentDeclarations = /* glsl */ `
varying vec3 vAtEye;
flat varying vec4 vTool;
uniform float toolRadius;
`;
const fragmentCode = /* glsl */ `
void main() {
  float along = dot(vAtEye, vTool.xyz);
  if (along < vTool.w - 1.2 * toolRadius) {
    float reach = ${clearRadii.toFixed(1)} * toolRadius * along / vTool.w;
    if (dot(vAtEye, vAtEye) - along * along < reach * reach) {
      vec2 pixel = mod(floor(gl_FragCoord.xy), 2.0);
      if (pixel.x + pixel.y > 0.0) discard;
    }
  }
`;

/// Makes a material see-through where it hides the tool. Returns the material.
export function seeThrough<T extends Material>(material: T): T {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.toolCenter = tool.center;
    shader.uniforms.toolRadius = tool.radius;
    shader.vertexShader = (vertexDeclarations + shader.vertexShader).replace(
      '#include <project_vertex>',
      vertexCode,
    );
    shader.fragmentShader = (fragmentDeclarations + shader.fragmentShader).replace(
      'void main() {',
      fragmentCode,
    );
  };
  return material;
}
