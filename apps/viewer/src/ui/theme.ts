// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId } from './dom';

export type Theme = 'light' | 'dark';
const key = 'pcavr-theme';

/// Throws where the browser blocks storage: the choice then lasts for the visit.
function loadTheme(): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function storeTheme(theme: Theme): void {
  try {
    localStorage.setItem(key, theme);
  } catch {
    // Storage is blocked: the choice lasts for this visit only.
  }
}

/// Light or dark: the system's setting, until the user selects one.
export class ThemeSwitch {
  private readonly button = byId('theme', HTMLButtonElement);
  private readonly system = matchMedia('(prefers-color-scheme: dark)');
  private chosen = loadTheme();

  onChange: (theme: Theme) => void = () => {};

  constructor() {
    this.system.addEventListener('change', () => this.apply());
    this.button.addEventListener('click', () => {
      const other = this.theme() === 'dark' ? 'light' : 'dark';
      this.chosen = other;
      storeTheme(other);
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
