// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// The keys held down while one of `elements` has the focus; a loss of focus releases all.
export class HeldKeys {
  private readonly held = new Set<string>();

  /// `codes`: the keys to track; their default actions (scroll, click) are suppressed.
  constructor(elements: readonly HTMLElement[], codes: readonly string[]) {
    for (const element of elements) {
      element.addEventListener('keydown', (event) => {
        if (!codes.includes(event.code) || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        if (!event.repeat) this.held.add(event.code);
      });
      element.addEventListener('keyup', (event) => {
        if (codes.includes(event.code)) event.preventDefault();
        this.held.delete(event.code);
      });
      element.addEventListener('blur', () => this.held.clear());
    }
    window.addEventListener('blur', () => this.held.clear());
  }

  has(code: string): boolean {
    return this.held.has(code);
  }

  /// +1, -1 or 0 from a pair of opposite keys.
  axis(positive: string, negative: string): number {
    return Number(this.has(positive)) - Number(this.has(negative));
  }
}
