// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from '../ui/dom';
import { saveText } from '../ui/plot_files';
import { csvOfTable } from './csv';
import type { TableData } from './report_data';
import { printed } from './typeset';

const maxNumber = 24; // characters: longer cells are text
const headlineRows = 5; // that are not folded
const maxShownRows = 12; // of a table that is not folded

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

/// A table with its title and note; folded and long ones open by a click, unless it is all that a
/// report has. `section` names a table without a title.
export function table(data: TableData, section: string, isOnly: boolean): HTMLElement {
  const name = data.title || section;
  const save = create('button', { type: 'button', textContent: 'Save CSV' });
  save.addEventListener('click', () => saveText(name, 'csv', 'text/csv', csvOfTable(data)));
  const parts: HTMLElement[] = [plainTable(data)];
  if (data.note) parts.push(create('p', { className: 'below', textContent: printed(data.note) }));
  const actions = create('span', { className: 'actions' }, save);
  if (!isOnly && (data.folded || data.rows.length > maxShownRows)) {
    const title = `${data.title || 'All values'} (${data.rows.length} ${data.rows.length === 1 ? 'row' : 'rows'})`;
    return create('details', {}, create('summary', {}, title), actions, ...parts);
  }
  const title = create('h3', { className: 'table-title' }, data.title, actions);
  return create('div', {}, title, ...parts);
}

/// The five main metrics; the others are folded.
export function headline(data: TableData): HTMLElement[] {
  if (data.rows.length === 0) return [];
  const first = data.rows.slice(0, headlineRows);
  const rest = data.rows.slice(headlineRows);
  const top = create('div', { className: 'headline' }, plainTable({ ...data, rows: first }));
  if (rest.length === 0) return [top];
  const title = `All main figures (${data.rows.length})`;
  const all = create('details', {}, create('summary', { textContent: title }), plainTable(data));
  return [top, all];
}

function plainTable(data: TableData): HTMLElement {
  const isNumber = numberColumns(data);
  const cell = (kind: 'th' | 'td', textContent: string, column: number) =>
    create(kind, {
      textContent: printed(textContent),
      className: isNumber[column] ? 'number' : '',
    });
  const row = (kind: 'th' | 'td', cells: string[]) =>
    create('tr', {}, ...cells.map((text, column) => cell(kind, text, column)));
  return create(
    'div',
    { className: 'scroll', tabIndex: 0 }, // the keyboard scrolls it
    create(
      'table',
      {},
      create('thead', {}, row('th', data.columns)),
      create('tbody', {}, ...data.rows.map((cells) => row('td', cells))),
    ),
  );
}
