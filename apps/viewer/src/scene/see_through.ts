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

const declarations = /* glsl */ `
varying vec3 vAtEye;
uniform vec3 toolCenter;
uniform float toolRadius;
`;

// Screen-door transparency: of what is nearer than the tool, in a cone from the eye around it, one
// pixel of four is drawn. It needs no sorting and works with any material.
const hole = /* glsl */ `
if (toolRadius > 0.0) {
  vec3 toTool = (viewMatrix * vec4(toolCenter, 1.0)).xyz;
  float toolDistance = length(toTool);
  float along = dot(vAtEye, toTool) / toolDistance;
  float across = length(vAtEye - along * toTool / toolDistance);
  bool isNearer = along < toolDistance - 1.2 * toolRadius;
  bool isInCone = across * toolDistance < ${clearRadii.toFixed(1)} * toolRadius * along;
  vec2 pixel = mod(floor(gl_FragCoord.xy), 2.0);
  if (isNearer && isInCone && pixel.x + pixel.y > 0.0) discard;
}
`;

/// Makes a material see-through where it hides the tool. Returns the material.
export function seeThrough<T extends Material>(material: T): T {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.toolCenter = tool.center;
    shader.uniforms.toolRadius = tool.radius;
    shader.vertexShader = `varying vec3 vAtEye;\n${shader.vertexShader}`.replace(
      '#include <project_vertex>',
      '#include <project_vertex>\nvAtEye = mvPosition.xyz;',
    );
    shader.fragmentShader = `${declarations}${shader.fragmentShader}`.replace(
      'void main() {',
      `void main() {\n${hole}`,
    );
  };
  return material;
}
