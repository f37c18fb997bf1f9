// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { LinkStamps } from '../link_protocol';

export const stageNames = [
  'Hand to command sent',
  'Command to robot',
  'At the robot until applied',
  'Applied to sensed',
  'Sensed to sent back',
  'Robot to this site',
  'Received to drawn',
] as const;

/// The durations [s] of the stages from the hand's motion to the frame that shows its effect, of
/// which the page adds the last: drawn at `drawn` on the page's clock. `offset`: the server's clock
/// minus the page's. They add up to `drawn - stamps.device`; null while a stamp is missing.
export function linkStages(stamps: LinkStamps, offset: number, drawn: number): number[] | null {
  const times = [
    stamps.device + offset,
    stamps.sent,
    stamps.received,
    stamps.applied,
    stamps.sensed,
    stamps.sentBack,
    stamps.receivedBack,
    drawn + offset,
  ];
  if (!times.every(Number.isFinite)) return null;
  return times.slice(1).map((time, i) => time - times[i]);
}
