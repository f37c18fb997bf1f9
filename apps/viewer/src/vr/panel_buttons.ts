// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Playback } from '../replay/playback';

/// In rows of three.
export const panelButtons = [
  'hold',
  'reset',
  'take',
  'scale',
  'recentre',
  'scan',
  'turn',
  'swap',
  'time',
  'leave',
  'place',
  'keep',
] as const;
export type PanelButton = (typeof panelButtons)[number];

/// What the labels depend on.
export interface ButtonState {
  isOnHold: boolean;
  isScanShown: boolean;
  canTake: boolean; // another page has the tool
  hasAsked: boolean; // for it
  isToolWanted: boolean; // this page has the tool, and another one asks for it
  canUndoReset: boolean; // since the last reset no body was touched
  timeScale: number; // simulated over real time
  isPassthrough: boolean; // the real room is behind the scene
  isPlacing: boolean; // the scene follows the hand
  playback: Playback | null; // of a replay
}

/// A replay's steps by the panel [s].
export const playbackStep = 1;

interface Label {
  text: string; // empty: the button is not there
  isLit: boolean;
}

/// A button's label. In a replay the world's buttons are the player's.
export function labelOf(button: PanelButton, state: ButtonState, isAsking: boolean): Label {
  const { playback } = state;
  const label = (text: string, isLit = false): Label => ({ text, isLit });
  switch (button) {
    case 'hold':
      if (playback) return label(playback.isPlaying ? 'PAUSE' : 'PLAY', playback.isPlaying);
      return label(state.isOnHold ? 'PAUSED' : 'PAUSE', state.isOnHold);
    case 'reset':
      if (playback) return label(`-${playbackStep} S`);
      if (state.canUndoReset) return label('UNDO', true);
      return label(isAsking ? 'SURE?' : 'RESET', isAsking);
    case 'take':
      if (playback) return label(`+${playbackStep} S`);
      if (state.isToolWanted) return label('GIVE', true);
      return state.hasAsked ? label('ASKED') : label(state.canTake ? 'ASK' : 'TAKE', state.canTake);
    case 'keep':
      return label(!playback && state.isToolWanted ? 'KEEP' : '', true);
    case 'swap':
      return label(playback ? `SPEED ${playback.speed}` : 'SWAP');
    case 'scan':
      return label(state.isScanShown ? 'NO SCAN' : 'SCAN');
    case 'time':
      if (playback) return label('');
      if (state.timeScale === 1) return label('TIME');
      return label(`TIME ${Math.round(100 * state.timeScale)}%`, true);
    case 'place':
      return label(
        state.isPassthrough ? (state.isPlacing ? 'DONE' : 'PLACE') : '',
        state.isPlacing,
      );
    default:
      return label(button.toUpperCase());
  }
}
