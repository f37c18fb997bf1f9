// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from './dom';

type Cell = string | number | null;

/// A named column; a number that is not finite leaves its cell empty.
export interface CsvColumn {
  name: string;
  values: ArrayLike<Cell>;
}

export type CsvTable = readonly CsvColumn[];

/// Downloads a text as a file; the name is made of `title`.
export function saveText(title: string, ending: string, type: string, text: string): void {
  const link = create('a', {
    href: URL.createObjectURL(new Blob([text], { type })),
    download: `${title.replace(/[^\p{L}\p{N}_]+/gu, '-')}.${ending}`,
  });
  link.click();
  URL.revokeObjectURL(link.href);
}

/// A table as CSV (RFC 4180).
export function csvText(table: CsvTable): string {
  const rows = Array.from({ length: table[0]?.values.length ?? 0 }, (_, row) =>
    csvRow(table.map(({ values }) => values[row])),
  );
  return [csvRow(table.map(({ name }) => name)), ...rows, ''].join('\r\n');
}

export function csvRow(cells: readonly Cell[]): string {
  return cells.map(csvCell).join(',');
}

function csvCell(cell: Cell): string {
  if (typeof cell !== 'string') return Number.isFinite(cell) ? String(cell) : '';
  return /[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell;
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
