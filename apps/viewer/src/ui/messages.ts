// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Notice } from '../protocol';
import { byId, create } from './dom';

const shownSeconds = { info: 4, warning: 7, error: 15 };
const maxShown = 4;

/// Shows notices as toasts, and announces them to screen readers.
export class Messages {
  private readonly toasts = byId('toasts', HTMLDivElement);
  private readonly announcer = byId('announcer', HTMLDivElement);

  /// One that is already shown is shown anew, not twice. `isPersistent`: does not time out, for
  /// errors that stop the page.
  show(notice: Notice, isPersistent = false): void {
    const toast = create('div', { className: notice.level, textContent: notice.text });
    if (notice.level === 'error') toast.setAttribute('role', 'alert');
    else this.announce(notice.text);
    for (const shown of [...this.toasts.children]) {
      if (shown.className === toast.className && shown.textContent === notice.text) shown.remove();
    }
    this.toasts.append(toast);
    while (this.toasts.children.length > maxShown) this.toasts.firstElementChild!.remove();
    if (!isPersistent)
      setTimeout(() => toast.remove(), 1000 * (shownSeconds[notice.level] ?? shownSeconds.info));
  }

  /// For screen readers only; replaces an announcement that was not read out yet.
  announce(text: string): void {
    this.announcer.textContent = text;
  }
}
