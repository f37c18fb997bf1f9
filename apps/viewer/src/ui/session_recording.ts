// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Command, type LiveState } from '../protocol';
import type { Session } from '../session/session';
import { byId, setPressed, setText } from './dom';

/// The button that records the session at the server, and where the recording went.
export class SessionRecording {
  private readonly line = byId('recording-line', HTMLDivElement);
  private readonly button = byId('record-session', HTMLButtonElement);
  private readonly place = byId('recording-place', HTMLOutputElement);

  constructor(session: Session) {
    this.button.addEventListener('click', () => {
      const isRecording = session.latest()?.isRecording ?? false;
      session.command(isRecording ? Command.stopRecording : Command.startRecording);
    });
    session.onNotice(({ about, text }) => {
      if (about === 'recording') setText(this.place, text);
    });
  }

  /// Once a drawn frame.
  update(state: LiveState | null, canRecord: boolean): void {
    this.line.hidden = !canRecord;
    this.button.disabled = state === null;
    setPressed(this.button, state?.isRecording ?? false);
    setText(this.button, state?.isRecording ? 'Stop recording' : 'Record session');
  }
}
