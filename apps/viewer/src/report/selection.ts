// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { create } from '../ui/dom';
import type { Range } from './view';

/// A selected part of a drawing, in its own units.
export interface Area {
  x: Range;
  y: Range;
}

const minDrag = 6; // [CSS pixels]: less is a click

/// Reports the part of the drawing that the user drags across: columns, or an area.
export function addSelection(
  element: HTMLElement,
  drawing: () => SVGSVGElement,
  onSelect: (area: Area) => void,
  selectsArea: boolean,
): void {
  const shade = create('div', { className: 'selection', hidden: true });
  element.append(shade);
  let start: PointerEvent | undefined;

  const sides = (end: PointerEvent, from: PointerEvent): Area => ({
    x: [Math.min(from.clientX, end.clientX), Math.max(from.clientX, end.clientX)],
    y: [Math.min(from.clientY, end.clientY), Math.max(from.clientY, end.clientY)],
  });
  const begin = (event: PointerEvent) => {
    // A finger scrolls the page.
    if (event.button !== 0 || event.pointerType === 'touch') return;
    start = event;
    element.setPointerCapture(event.pointerId);
    event.preventDefault();
    event.stopPropagation();
  };
  // Before the chart, which would otherwise fix the values that it shows for the pointer.
  element.addEventListener('pointerdown', begin, { capture: true });
  element.addEventListener('pointermove', (event) => {
    if (!start) return;
    const { x, y } = sides(event, start);
    const box = element.getBoundingClientRect();
    shade.hidden = x[1] - x[0] < minDrag;
    shade.style.left = `${x[0] - box.left}px`;
    shade.style.width = `${x[1] - x[0]}px`;
    shade.style.top = selectsArea ? `${y[0] - box.top}px` : '0';
    shade.style.height = selectsArea ? `${y[1] - y[0]}px` : '100%';
  });
  element.addEventListener('pointerup', (event) => {
    if (!start) return;
    const { x, y } = sides(event, start);
    start = undefined;
    shade.hidden = true;
    if (x[1] - x[0] < minDrag) return;
    const svg = drawing();
    const box = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / box.width;
    onSelect({
      x: x.map((value) => (value - box.left) * scale) as Range,
      y: y.map((value) => (value - box.top) * scale) as Range,
    });
  });
  element.addEventListener('pointercancel', () => {
    start = undefined;
    shade.hidden = true;
  });
}
