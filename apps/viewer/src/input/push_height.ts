// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { type Box3, type Vector3 } from 'three';

/// A body as the tool meets it: its box in base [m].
export interface Obstacle {
  name: string;
  box: Box3;
  isMovable: boolean;
}

const maxReach = 0.5; // [m] from the tool to a body that it may be about to push
const margin = 0.01; // [m] around a body that the tool passes on its way down

/// From a point to the side of a box, level [m]; 0 above, below or inside of it.
export function levelDistance({ x, y }: Vector3, { min, max }: Box3): number {
  return Math.hypot(Math.max(min.x - x, 0, x - max.x), Math.max(min.y - y, 0, y - max.y));
}

/// The movable body that is the nearest to the tool, level.
export function nearestMovable(tool: Vector3, obstacles: readonly Obstacle[]): Obstacle | null {
  const movable = obstacles.filter(({ isMovable, box }) => isMovable && !box.isEmpty());
  const distances = movable.map(({ box }) => levelDistance(tool, box));
  return movable[distances.indexOf(Math.min(...distances))] ?? null;
}

/// The mid-height [m] of a box, but no lower than a tool of this radius on what the box stands on.
export function midHeight({ min, max }: Box3, radius: number): number {
  return Math.max((min.z + max.z) / 2, min.z + 1.1 * radius);
}

/// The height [m] in base from which a level motion of the tool pushes the nearest movable body;
/// null where the tool is level with it, far from it, or above or below another body.
export function pushHeight(
  tool: Vector3,
  radius: number,
  obstacles: readonly Obstacle[],
): number | null {
  const nearest = nearestMovable(tool, obstacles);
  if (!nearest || levelDistance(tool, nearest.box) > maxReach) return null;
  const { min, max } = nearest.box;
  if (tool.z > min.z && tool.z < max.z) return null;
  const blocks = ({ box }: Obstacle) => levelDistance(tool, box) <= radius + margin;
  return obstacles.some(blocks) ? null : midHeight(nearest.box, radius);
}

/// Why a drag that came as near as `tool` to a body touched nothing.
export function missText(tool: Vector3, radius: number, obstacles: readonly Obstacle[]): string {
  const nearest = nearestMovable(tool, obstacles);
  if (!nearest) return '';
  const { name, box } = nearest;
  const cm = (distance: number) => `${Math.max(1, Math.round(100 * distance))} cm`;
  const above = tool.z - radius - box.max.z;
  const below = box.min.z - tool.z - radius;
  if (above > 0) return `The tool passes ${cm(above)} above ${name}: pull it down by ↕`;
  if (below > 0) return `The tool passes ${cm(below)} below ${name}: pull it up by ↕`;
  const distance = levelDistance(tool, box) - radius;
  return `The tool stops ${cm(distance)} before ${name}: drag it farther`;
}
