// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector3 } from 'three';
import type { LiveState } from '../protocol';
import { levelDistance, missText, nearestMovable, type Obstacle } from './push_height';

const maxSilentMisses = 1; // the second drag without a touch is explained

/// Drags in which the tool touched nothing: counted, and explained by where the tool came nearest to
/// a body.
export class Misses {
  text = ''; // why the last drag touched nothing; empty where nothing has to be explained
  private count = 0;
  private hasTouched = false; // in this drag
  private nearest = Infinity; // [m] level, in this drag
  private reason = '';

  /// Once a frame of a drag.
  add(state: LiveState, tool: Vector3, radius: number, obstacles: readonly Obstacle[]): void {
    this.hasTouched ||= state.touchedObject >= 0;
    const body = nearestMovable(tool, obstacles);
    if (!body || levelDistance(tool, body.box) > this.nearest) return;
    this.nearest = levelDistance(tool, body.box);
    this.reason = missText(tool, radius, obstacles);
  }

  endDrag(): void {
    this.count = this.hasTouched ? 0 : this.count + 1;
    this.text = this.count > maxSilentMisses ? this.reason : '';
    this.hasTouched = false;
    this.nearest = Infinity;
  }
}
