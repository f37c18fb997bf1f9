// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// The element with this id in index.html; throws if it is missing or of another type.
export function byId<T extends HTMLElement>(id: string, type: new () => T): T {
  const element = document.getElementById(id);
  if (!(element instanceof type)) throw new Error(`no ${type.name} #${id} in the page`);
  return element;
}

export function create<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/// Fills a <dl> with rows of name and value.
export function fillList(list: HTMLElement, rows: readonly (readonly [string, string])[]): void {
  list.replaceChildren(
    ...rows.map(([name, value]) =>
      create('div', {}, create('dt', { textContent: name }), create('dd', { textContent: value })),
    ),
  );
}

export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function setPressed(button: HTMLButtonElement, isPressed: boolean): void {
  const text = String(isPressed);
  if (button.getAttribute('aria-pressed') !== text) button.setAttribute('aria-pressed', text);
}
