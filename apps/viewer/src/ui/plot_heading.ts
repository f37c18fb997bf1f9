// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { hatchClass } from '../hatch';
import { create, setPressed, setText } from './dom';
import type { PlotOptions, PlotSeries } from './plot_options';

interface Actions {
  showComponents: (areShown: boolean) => void;
  showAll: () => void;
  saveDrawing: () => void;
  saveTable: () => void;
}

/// A plot's title, legend and buttons.
export class PlotHeading {
  readonly element: HTMLElement;
  private readonly title: HTMLElement;
  private readonly componentKeys: HTMLElement[];
  private readonly showAll: HTMLButtonElement;

  constructor(options: PlotOptions, actions: Actions) {
    const { title, note, series, bandKeys = [] } = options;
    this.title = create('span', { className: 'title', textContent: title });
    this.componentKeys = series.filter(({ isComponent }) => isComponent).map(keyOf('key'));
    this.showAll = button('Show all', 'Ends the zoom.', actions.showAll);
    this.showAll.hidden = true;
    const buttons = [
      this.showAll,
      ...this.componentsButton(actions),
      button('SVG', 'Saves the plot as a drawing.', actions.saveDrawing),
      button('CSV', 'Saves all rows of the plotted numbers as a table.', actions.saveTable),
    ];
    this.element = create(
      'h3',
      {},
      this.title,
      ...series.filter(({ isComponent }) => !isComponent).map(keyOf('key')),
      ...this.componentKeys,
      ...bandKeys.map(keyOf('key area')),
      ...(note ? [create('span', { className: 'note', textContent: note, title: note })] : []),
      create('span', { className: 'actions' }, ...buttons),
    );
    this.showComponents(false);
  }

  setTitle(title: string): void {
    setText(this.title, title);
  }

  setZoomed(isZoomed: boolean): void {
    this.showAll.hidden = !isZoomed;
  }

  private componentsButton(actions: Actions): HTMLButtonElement[] {
    if (this.componentKeys.length === 0) return [];
    const toggle = button('x y z', "Shows the force's components along the axes of base.", () => {
      const areShown = toggle.getAttribute('aria-pressed') !== 'true';
      setPressed(toggle, areShown);
      this.showComponents(areShown);
      actions.showComponents(areShown);
    });
    setPressed(toggle, false);
    return [toggle];
  }

  private showComponents(areShown: boolean): void {
    for (const key of this.componentKeys) key.hidden = !areShown;
  }
}

function keyOf(className: string): (entry: PlotSeries) => HTMLElement {
  return ({ title, color }) => {
    const key = create('span', { className, textContent: title });
    key.style.setProperty('--key', color);
    if (className === 'key area' && hatchClass(color)) key.classList.add(hatchClass(color));
    return key;
  };
}

function button(textContent: string, title: string, action: () => void): HTMLButtonElement {
  const element = create('button', { type: 'button', textContent, title });
  element.addEventListener('click', action);
  return element;
}
