// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from './dom';

/// Downloads a text as a file; the name is made of `title`.
export function saveText(title: string, ending: string, type: string, text: string): void {
  const link = create('a', {
    href: URL.createObjectURL(new Blob([text], { type })),
    download: `${title.replace(/[^\p{L}\p{N}_]+/gu, '-')}.${ending}`,
  });
  link.click();
  URL.revokeObjectURL(link.href);
}

/// A table as CSV (RFC 4180); a number that is not finite leaves its cell empty.
export function csvText(
  names: readonly string[],
  columns: readonly ArrayLike<number | null>[],
): string {
  const quoted = names.map((name) =>
    /[",\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name,
  );
  const rows = Array.from({ length: columns[0]?.length ?? 0 }, (_, row) =>
    columns.map((column) => (Number.isFinite(column[row]) ? String(column[row]) : '')).join(','),
  );
  return [quoted.join(','), ...rows, ''].join('\r\n');
}

/// A drawing as a file that looks the same without the page's style sheet.
export function svgText(drawing: Element, color: string): string {
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  copy.setAttribute('color', color);
  const style = getComputedStyle(document.documentElement);
  return new XMLSerializer()
    .serializeToString(copy)
    .replace(/var\((--[\w-]+)\)/g, (_, name: string) => style.getPropertyValue(name).trim());
}
