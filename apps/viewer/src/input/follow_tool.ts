// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import type { Navigation } from './navigation';

const followSeconds = 0.2; // for most of a distance: the view glides, it does not jitter
const minStep = 1e-5; // [m] less is not seen

/// Moves the view along with the tool. It stands still while the pointer moves the tool: the pointer
/// would mean another place with each move of the view, and the tool would run away.
export class FollowTool {
  isOn = false;
  private at: Vector3 | null = null; // what the view is at, in the scene

  constructor(
    private readonly app: App,
    private readonly navigation: Navigation,
    private readonly isPointed: () => boolean,
  ) {}

  /// `seconds` since the previous frame.
  update(seconds: number): void {
    const { renderer, view } = this.app;
    if (!this.isOn || !view.tool.group.visible || renderer.xr.isPresenting) {
      this.at = null;
      return;
    }
    if (this.isPointed()) return;
    const tool = view.tool.proxy.getWorldPosition(new Vector3());
    this.at ??= this.start(tool);
    const step = tool.sub(this.at).multiplyScalar(1 - Math.exp(-seconds / followSeconds));
    if (step.length() < minStep) return;
    this.at.add(step);
    this.navigation.shift(step);
    this.app.invalidate();
  }

  /// From the middle of the view; a walker stays where he is.
  private start(tool: Vector3): Vector3 {
    const { mode, controls } = this.navigation;
    return mode === 'walk' ? tool.clone() : controls.target.clone();
  }
}
