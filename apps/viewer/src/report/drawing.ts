// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import * as Plot from '@observablehq/plot';

/// A plot as one image with its title for screen readers: the library labels each of its parts, which
/// is allowed of none of them. What a part is stays in `data-mark`.
export function draw(options: Plot.PlotOptions): Plot.Plot & SVGSVGElement {
  const plot = Plot.plot(options) as Plot.Plot & SVGSVGElement;
  plot.setAttribute('role', 'img');
  for (const part of plot.querySelectorAll('[aria-label]')) {
    part.setAttribute('data-mark', part.getAttribute('aria-label')!);
    part.removeAttribute('aria-label');
  }
  return plot;
}
