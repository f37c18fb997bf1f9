// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { ArmState } from '../src/protocol';
import type { ArmModel } from '../src/scene/arm';
import { armText } from '../src/ui/arm_text';

test('the line names the body, the scan or the guard before which the arm was stopped', () => {
  const arm = { links: [{ name: 'elbow' }] } as unknown as ArmModel;
  const stoppedBefore = (object: number | null): ArmState => ({
    position: [],
    isStopped: true,
    isReached: false,
    nearest: { distance: 0.012, link: 0, otherLink: null, object },
  });
  const texts = [0, 1, null].map((object) => armText(stoppedBefore(object), arm, ['box']));
  assert.deepEqual(texts, [
    'arm stopped: elbow would hit box (12 mm)',
    'arm stopped: elbow would hit a guard (12 mm)',
    'arm stopped: elbow would hit the scan (12 mm)',
  ]);
});
