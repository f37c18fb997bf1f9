// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, create } from '../ui/dom';
import { laneFigure, plotFigure } from './figure';
import { type Block, readReport, type ReportData } from './report_data';
import { headline, table } from './tables';

function header(report: ReportData): HTMLElement[] {
  const lines = report.inputs.map((spans) =>
    create(
      'p',
      { className: 'input' },
      ...spans.map(({ text, strong }) => (strong ? create('b', { textContent: text }) : text)),
    ),
  );
  return [create('h1', { textContent: report.heading }), ...lines, ...report.notes.map(note)];
}

function note(text: string): HTMLElement {
  return create('p', { className: 'note', textContent: text });
}

function block(data: Block): HTMLElement {
  switch (data.kind) {
    case 'text':
      return data.highlighted
        ? note(data.text)
        : create('p', { className: 'below', textContent: data.text });
    case 'plots': {
      const title = data.title ? [create('h3', { textContent: data.title })] : [];
      const plots = create('div', { className: 'plots' }, ...data.plots.map(plotFigure));
      return create('div', {}, ...title, plots);
    }
    case 'lanes':
      return laneFigure(data);
    case 'tables':
      return create('div', { className: 'tables' }, ...data.tables.map(table));
  }
}

function show(report: ReportData): void {
  document.title = report.title;
  const hint = 'Plots: point at a line for its values, drag across to zoom in.';
  byId('report', HTMLElement).append(
    ...header(report),
    ...headline(report.headline),
    create('p', { className: 'below screen-only', textContent: hint }),
    ...report.sections.map(({ title, blocks }) =>
      create('section', {}, create('h2', { textContent: title }), ...blocks.map(block)),
    ),
    create('footer', { textContent: report.footer }),
  );
}

show(readReport(byId('report-data', HTMLScriptElement).text));
// A printed report has all its tables.
addEventListener('beforeprint', () => {
  for (const details of document.querySelectorAll('details')) details.open = true;
});
