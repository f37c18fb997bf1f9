// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import './tool_request.css';
import { Command, type LiveState } from '../protocol';
import type { Session } from '../session/session';
import { byId, create } from './dom';

/// On the page that has the tool: another one asks for it.
export class ToolRequest {
  private readonly box = create('div', { id: 'tool-request', hidden: true });

  constructor(session: Session, disengage: () => void) {
    this.box.setAttribute('role', 'alert');
    const button = (id: string, textContent: string, command: Command) => {
      const made = create('button', { id, type: 'button', textContent });
      made.addEventListener('click', () => session.command(command));
      return made;
    };
    const handOver = button('hand-over', 'Hand it over', Command.handOver);
    handOver.addEventListener('click', disengage);
    const text = 'Another page asks for the tool. It gets it after 10 s with the clutch open.';
    this.box.append(
      create('span', { textContent: text }),
      handOver,
      button('keep', 'Keep it', Command.keep),
    );
    byId('stage', HTMLElement).append(this.box);
  }

  update(state: LiveState | null): void {
    this.box.hidden = !state?.isToolWanted;
  }
}
