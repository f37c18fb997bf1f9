// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, create } from '../ui/dom';
import { laneFigure, plotFigure } from './figure';
import { type Block, readReport, type ReportData } from './report_data';
import { headline, table } from './tables';
import { printed } from './typeset';

const openSections = 3; // the others are folded

/// What was found first, then what it rests on.
function header(report: ReportData): HTMLElement[] {
  const lines = report.inputs.map((spans) =>
    create(
      'p',
      { className: 'input' },
      ...spans.map(({ text, strong }) => (strong ? create('b', { textContent: text }) : text)),
    ),
  );
  const verdict = report.verdict
    ? [create('p', { className: 'verdict', textContent: printed(report.verdict) })]
    : [];
  const heading = create('h1', { textContent: report.heading });
  const figures = headline(report.headline);
  return [heading, ...verdict, ...figures, ...report.notes.map(note), ...lines];
}

function note(text: string): HTMLElement {
  return create('p', { className: 'note', textContent: text });
}

function block(data: Block, section: string, isOnly: boolean): HTMLElement {
  switch (data.kind) {
    case 'text':
      return data.highlighted
        ? note(data.text)
        : create('p', { className: 'below', textContent: data.text });
    case 'picture':
      return create(
        'figure',
        { className: 'wide' },
        create('figcaption', { textContent: data.title }),
        create('img', { src: data.source, alt: data.title }),
        create('p', { className: 'below', textContent: data.note }),
      );
    case 'plots': {
      const title = data.title ? [create('h3', { textContent: data.title })] : [];
      const plots = create('div', { className: 'plots' }, ...data.plots.map(plotFigure));
      return create('div', {}, ...title, plots);
    }
    case 'lanes':
      return laneFigure(data);
    case 'tables':
      return create(
        'div',
        { className: 'tables' },
        ...data.tables.map((one) => table(one, section, isOnly && data.tables.length === 1)),
      );
  }
}

/// The command that made the report, where it is known, and the date of the file, which has none in
/// its bytes: the same input gives the same report.
function origin({ command = '' }: ReportData): HTMLElement[] {
  if (command === '') return [];
  const date = new Date(document.lastModified).toISOString().slice(0, 16).replace('T', ' ');
  const code = create('code', { textContent: command });
  return [create('p', { className: 'origin' }, 'Made by ', code, `; file of ${date} UTC`)];
}

/// Links to the sections; none for a report that fits a screen.
function contents(sections: readonly HTMLDetailsElement[]): HTMLElement[] {
  if (sections.length < 3) return [];
  const links = sections.map((section) => {
    const link = create('a', { href: `#${section.id}`, textContent: section.dataset.title ?? '' });
    link.addEventListener('click', () => (section.open = true));
    return create('li', {}, link);
  });
  const list = create('ol', {}, ...links);
  return [create('nav', { className: 'contents screen-only', ariaLabel: 'Contents' }, list)];
}

function section(
  { title, blocks }: ReportData['sections'][number],
  i: number,
  { length }: ReportData['sections'],
) {
  const summary = create('summary', {}, create('h2', { textContent: title }));
  const isOnly = length === 1 && blocks.length === 1;
  const content = blocks.map((one) => block(one, title, isOnly));
  const details = create('details', { className: 'section', id: `section-${i + 1}` });
  details.open = i < openSections;
  details.dataset.title = title;
  details.append(summary, ...content);
  return details;
}

function show(report: ReportData): void {
  document.title = report.title;
  const hasPlots = report.sections.some(({ blocks }) =>
    blocks.some(({ kind }) => kind === 'plots'),
  );
  const hint = hasPlots ? 'Plots: point at a line for its values, drag across to zoom in.' : '';
  const sections = report.sections.map(section);
  byId('report', HTMLElement).append(
    ...header(report),
    ...contents(sections),
    create('p', { className: 'below screen-only', textContent: hint }),
    ...sections,
    create('footer', {}, create('p', { textContent: report.footer }), ...origin(report)),
  );
}

show(readReport(byId('report-data', HTMLScriptElement).text));
// A printed report has all its plots; long tables stay folded, their values are in report.json.
addEventListener('beforeprint', () => {
  for (const one of document.querySelectorAll<HTMLDetailsElement>('details.section'))
    one.open = true;
});
