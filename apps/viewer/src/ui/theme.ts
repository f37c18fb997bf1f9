// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId } from './dom';
import { readStored, store } from './stored';

export type Theme = 'light' | 'dark';
const key = 'theme';

/// Light or dark: the system's setting, until the user selects one.
export class ThemeSwitch {
  private readonly button = byId('theme', HTMLButtonElement);
  private readonly system = matchMedia('(prefers-color-scheme: dark)');
  private chosen = readStored(key);

  onChange: (theme: Theme) => void = () => {};

  constructor() {
    this.system.addEventListener('change', () => this.apply());
    this.button.addEventListener('click', () => {
      const other = this.theme() === 'dark' ? 'light' : 'dark';
      this.chosen = other;
      store(key, other);
      this.apply();
    });
    this.apply();
  }

  theme(): Theme {
    if (this.chosen === 'light' || this.chosen === 'dark') return this.chosen;
    return this.system.matches ? 'dark' : 'light';
  }

  private apply(): void {
    const theme = this.theme();
    document.documentElement.dataset.theme = theme;
    this.button.textContent = theme === 'dark' ? 'Light' : 'Dark';
    this.onChange(theme);
  }
}
