// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a user has chosen, for the next visit. Where the browser blocks storage a choice lasts for the
// visit only.

export function readStored(key: string): string | null {
  try {
    return localStorage.getItem(`pcavr-${key}`);
  } catch {
    return null;
  }
}

export function store(key: string, value: string): void {
  try {
    localStorage.setItem(`pcavr-${key}`, value);
  } catch {
    // Storage is blocked.
  }
}
