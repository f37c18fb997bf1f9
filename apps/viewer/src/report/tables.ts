// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from '../ui/dom';
import type { TableData } from './report_data';

const maxNumber = 24; // characters: longer cells are text
const maxHeadlineRows = 14; // of one column

/// By column, whether it is aligned as numbers. The first names the rows.
export function numberColumns({ columns, rows }: TableData): boolean[] {
  const isNumber = (cell: string) =>
    cell.length <= maxNumber && /^(-?\d.*|-|never|missed|unknown|not identified|)$/.test(cell);
  const hasDigit = (cell: string) => /\d/.test(cell);
  return columns.map((_, i) => {
    const cells = rows.map((row) => row[i]);
    return i > 0 && cells.every(isNumber) && cells.some(hasDigit);
  });
}

/// A table with its title and note; folded ones open by a click, and for printing.
export function table(data: TableData): HTMLElement {
  const parts: HTMLElement[] = [plainTable(data)];
  if (data.note) parts.push(create('p', { className: 'below', textContent: data.note }));
  if (data.folded) {
    return create('details', {}, create('summary', { textContent: data.title }), ...parts);
  }
  const title = data.title ? [create('h3', { textContent: data.title })] : [];
  return create('div', {}, ...title, ...parts);
}

/// The main metrics; a long list in two columns.
export function headline(data: TableData): HTMLElement[] {
  if (data.rows.length === 0) return [];
  const half = Math.ceil(data.rows.length / 2);
  const parts =
    data.rows.length > maxHeadlineRows
      ? [data.rows.slice(0, half), data.rows.slice(half)]
      : [data.rows];
  const tables = parts.map((rows) => plainTable({ ...data, rows }));
  return [create('div', { className: 'headline' }, ...tables)];
}

function plainTable(data: TableData): HTMLElement {
  const isNumber = numberColumns(data);
  const cell = (kind: 'th' | 'td', textContent: string, column: number) =>
    create(kind, { textContent, className: isNumber[column] ? 'number' : '' });
  const row = (kind: 'th' | 'td', cells: string[]) =>
    create('tr', {}, ...cells.map((text, column) => cell(kind, text, column)));
  return create(
    'div',
    { className: 'scroll' },
    create(
      'table',
      {},
      create('thead', {}, row('th', data.columns)),
      create('tbody', {}, ...data.rows.map((cells) => row('td', cells))),
    ),
  );
}
