// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId } from './dom';

export type Theme = 'light' | 'dark';
const key = 'pcavr-theme';

/// Forbidden storage (a setting of some browsers) throws: the choice then lasts for the visit.
function remembered(): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function remember(theme: Theme): void {
  try {
    localStorage.setItem(key, theme);
  } catch {
    // Nothing to be done, and nothing that anyone would miss.
  }
}

/// Light or dark: as the system has it, until the user says otherwise.
export class ThemeSwitch {
  private readonly button = byId('theme', HTMLButtonElement);
  private readonly system = matchMedia('(prefers-color-scheme: dark)');
  private chosen = remembered();

  onChange: (theme: Theme) => void = () => {};

  constructor() {
    this.system.addEventListener('change', () => this.apply());
    this.button.addEventListener('click', () => {
      const other = this.theme() === 'dark' ? 'light' : 'dark';
      this.chosen = other;
      remember(other);
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
