// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Notice } from '../protocol';
import { byId, create } from './dom';

const shownSeconds = { info: 4, warning: 7, error: 15 };
const maxShown = 4;

/// Notices, for eyes and for screen readers.
export class Messages {
  private readonly toasts = byId('toasts', HTMLDivElement);
  private readonly announcer = byId('announcer', HTMLDivElement);

  /// `stays`: without what it says is wrong there is no page to speak of.
  show(notice: Notice, stays = false): void {
    const toast = create('div', { className: notice.level, textContent: notice.text });
    if (notice.level === 'error') toast.setAttribute('role', 'alert');
    else this.announce(notice.text);
    this.toasts.append(toast);
    while (this.toasts.children.length > maxShown) this.toasts.firstElementChild!.remove();
    if (!stays)
      setTimeout(() => toast.remove(), 1000 * (shownSeconds[notice.level] ?? shownSeconds.info));
  }

  /// For screen readers only; what is said again at once replaces what was not said yet.
  announce(text: string): void {
    this.announcer.textContent = text;
  }
}
