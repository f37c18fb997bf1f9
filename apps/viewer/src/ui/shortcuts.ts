// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import './shortcuts.css';
import { byId, create, fillList } from './dom';

type Keys = readonly (readonly [string, string])[];

const liveKeys: Keys = [
  ['Space with arrows', 'moves the tool level; Shift: slowly'],
  ['Space with Page Up, Page Down', 'moves the tool up and down'],
  ['Escape', 'opens the clutch'],
  ['H', 'holds the tool, and resumes'],
  ['X', 'emergency stop, on all pages and at the robot'],
];
const replayKeys: Keys = [
  ['Space', 'plays and pauses'],
  ['← →', '0.1 s back and forward; Shift: 1 s'],
  ['N, P', 'to the next event, to the one before'],
  ['Home, End', 'to the beginning and the end'],
];
const commonKeys: Keys = [
  ['W A S D, E Q', 'moves the view; up and down'],
  ['I J K L', 'turns the view'],
  ['↑ ↓ on the edge above the plots', 'makes the plots higher and lower'],
  ['?', 'shows these keys'],
];

/// Whether a key belongs to what is being typed.
const isTyping = ({ target }: KeyboardEvent) =>
  target instanceof HTMLInputElement || target instanceof HTMLSelectElement;

/// The dialog of all keys: by its button or "?".
export function addShortcuts(isReplay: boolean): void {
  const list = create('dl');
  fillList(list, [...(isReplay ? replayKeys : liveKeys), ...commonKeys]);
  const close = create('button', { type: 'submit', textContent: 'Close' });
  const form = create(
    'form',
    { method: 'dialog' },
    create('h2', { textContent: 'Keys' }),
    list,
    close,
  );
  const dialog = create('dialog', { id: 'shortcuts' }, form);
  dialog.setAttribute('aria-label', 'Keys');
  document.body.append(dialog);
  const show = () => {
    if (!dialog.open) dialog.showModal();
    dialog.scrollTop = 0; // the focused button is at its end
  };
  byId('show-shortcuts', HTMLButtonElement).addEventListener('click', show);
  window.addEventListener('keydown', (event) => {
    if (event.key === '?' && !isTyping(event)) show();
  });
}
