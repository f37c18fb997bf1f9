// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { byId, create } from '../ui/dom';
import type { ReplayObject } from './replay_data';
import { touchedAt } from './touched';

/// Which object is plotted: the one that the tool touches, or one that the user has chosen.
export class PlottedObject {
  private readonly select = byId('plotted', HTMLSelectElement);

  constructor(
    private readonly objects: readonly ReplayObject[],
    onChange: () => void,
  ) {
    this.select.append(
      create('option', { value: '', textContent: 'touched object' }),
      ...objects.map(({ name }) => create('option', { value: name, textContent: name })),
    );
    this.select.hidden = objects.length < 2;
    this.select.addEventListener('change', onChange);
  }

  at(time: number): ReplayObject | undefined {
    const chosen = this.objects.find(({ name }) => name === this.select.value);
    return chosen ?? touchedAt(this.objects, time);
  }
}
