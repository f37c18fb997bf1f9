// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Group } from 'three';

export const layerNames = [
  'mesh',
  'unseen',
  'cloud',
  'occupancy',
  'bodies',
  'arm',
  'ghosts',
  'labels',
  'tags',
  'frames',
  'planes',
  'guards',
  'cameras',
] as const;
export type LayerName = (typeof layerNames)[number];

export const layerTitles: Record<LayerName, string> = {
  mesh: 'Scanned mesh',
  unseen: 'Filled in',
  cloud: 'Point cloud',
  occupancy: 'Occupied cells',
  bodies: 'CAD bodies',
  arm: 'Robot',
  ghosts: 'Tracked ghosts',
  labels: 'Labels',
  tags: 'Tags',
  frames: 'Frames',
  planes: 'Support planes',
  guards: 'Guard surfaces',
  cameras: 'Camera path',
};

/// A sentence on hover.
export const layerHints: Record<LayerName, string> = {
  mesh: 'The surface that the camera recorded, without the objects that can be moved.',
  unseen: 'Parts of the table that no image shows because an object was in front: a guess.',
  cloud: 'The recorded points, averaged.',
  occupancy: 'Where the recording has something, as cubes.',
  bodies: 'The objects by their CAD models, where the simulation has them.',
  arm: "The robot's base with its axes (x red, y green, z blue), and its links where they are known.",
  ghosts: 'Outlines of the objects where the camera tracked them.',
  labels: 'Names of the objects, and how they move.',
  tags: 'The printed tags that cameras find.',
  frames: 'Axes of base and objects: x red, y green, z blue.',
  planes: 'The surfaces that objects stand on.',
  guards: 'Surfaces that stop the tool.',
  cameras: 'Where the camera was while recording.',
};

const shownAtFirst: readonly LayerName[] = [
  'mesh',
  'unseen',
  'bodies',
  'arm',
  'ghosts',
  'labels',
  'guards',
];

/// The layers to show and hide: a group each, all in base.
export class Layers {
  private groups = new Map<LayerName, Group>();
  private listeners: ((name: LayerName, isShown: boolean) => void)[] = [];

  constructor(base: Group) {
    for (const name of layerNames) {
      const group = new Group();
      group.name = name;
      group.visible = shownAtFirst.includes(name);
      this.groups.set(name, group);
      base.add(group);
    }
  }

  group(name: LayerName): Group {
    return this.groups.get(name)!;
  }

  isShown(name: LayerName): boolean {
    return this.group(name).visible;
  }

  show(name: LayerName, isShown: boolean): void {
    if (this.isShown(name) === isShown) return;
    this.group(name).visible = isShown;
    this.listeners.forEach((listener) => listener(name, isShown));
  }

  onChange(listener: (name: LayerName, isShown: boolean) => void): void {
    this.listeners.push(listener);
  }

  all(): Record<LayerName, boolean> {
    return Object.fromEntries(layerNames.map((n) => [n, this.isShown(n)])) as Record<
      LayerName,
      boolean
    >;
  }
}
