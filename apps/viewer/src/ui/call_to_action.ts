// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LiveState } from '../protocol';
import { byId, setText } from './dom';
import { length } from './format';
import { moveTo } from './labels';

const gap = 30; // [CSS pixels] from the ring's centre
const minAbove = 110; // [CSS pixels] over the ring's centre

/// What to do first, at the ring, and after drags that touched nothing why; gone after the first push by this page, or
/// where nothing can be pushed the first touch of the scan.
export class CallToAction {
  private readonly element = byId('call-to-action', HTMLElement);
  private readonly task: string;
  private isDone = false;

  constructor(private readonly hasBodies: boolean) {
    this.task = hasBodies ? 'Drag the ring to push' : 'Drag the ring to touch the scan';
  }

  /// `ring`: its centre on the stage [CSS pixels]; null while it is not shown. `miss`: why the last drags touched
  /// nothing; may be empty.
  update(state: LiveState | null, ring: { x: number; y: number } | null, miss: string): void {
    setText(this.element, miss || this.task);
    if (state?.hasTool && state.isEngaged)
      this.isDone ||= this.hasBodies ? state.touchedObject >= 0 : length(state.force) > 0;
    const isHeld = !state || state.isOnHold || state.isStopped || state.link?.isConnected === false;
    const isFree = !isHeld && (state.hasTool || !state.isToolTaken);
    this.element.hidden = (this.isDone && miss === '') || !isFree || ring === null;
    if (!ring || this.element.hidden) return;
    // Below a ring near the upper edge, where the statistics are.
    const isBelow = ring.y < minAbove;
    this.element.classList.toggle('below', isBelow);
    moveTo(this.element, ring.x, ring.y + (isBelow ? gap : -gap));
  }
}
