// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { layerHints, layerNames, layerTitles, type LayerName, type Layers } from '../scene/layers';
import { hasRobotBase, hasScan, type SceneModel } from '../scene/scene_model';
import { byId, create } from './dom';
import { count } from './format';

/// A checkbox for each layer; disabled if the scene has no data for it. Returns a function that
/// enables one whose data have come.
export function fillLayersPanel(
  layers: Layers,
  present: readonly LayerName[],
): (name: LayerName) => void {
  const panel = byId('layers', HTMLDivElement);
  const boxes = new Map<LayerName, HTMLInputElement>();
  for (const name of layerNames) {
    const box = create('input', { type: 'checkbox', id: `layer-${name}` });
    box.checked = layers.isShown(name) && present.includes(name);
    box.disabled = !present.includes(name);
    box.addEventListener('change', () => layers.show(name, box.checked));
    boxes.set(name, box);
    const label = create('label', { title: layerHints[name] }, box, layerTitles[name]);
    label.classList.toggle('absent', box.disabled);
    panel.append(label);
  }
  layers.onChange((name, isShown) => (boxes.get(name)!.checked = isShown));
  return (name) => {
    const box = boxes.get(name)!;
    box.disabled = false;
    box.checked = layers.isShown(name);
    box.parentElement!.classList.remove('absent');
  };
}

/// The layers for which the scene has data.
export function presentLayers(model: SceneModel, isReplay: boolean): LayerName[] {
  const has: Record<LayerName, boolean> = {
    mesh: hasScan(model),
    unseen: model.unseen_support !== null,
    cloud: (model.cloud?.points ?? 0) > 0,
    occupancy: (model.occupancy?.cells ?? 0) > 0,
    bodies: model.objects.length > 0,
    arm: hasRobotBase(model),
    ghosts: isReplay,
    labels: model.objects.length > 0,
    tags: model.tags.length > 0,
    frames: true,
    planes: model.support_planes.length > 0,
    guards: model.guards.length > 0,
    cameras: model.cameras.length > 0,
  };
  return layerNames.filter((name) => has[name]);
}

/// Fills the selection of the scan's level of detail; returns a function that shows the level.
export function fillDetail(model: SceneModel, onChoice: (level: number) => void) {
  const select = byId('detail', HTMLSelectElement);
  select.replaceChildren(
    ...model.mesh.map(({ triangles }, level) =>
      create('option', {
        value: String(level),
        textContent: `${count(triangles)} triangles`,
      }),
    ),
  );
  select.disabled = model.mesh.length < 2;
  byId('detail-line', HTMLElement).hidden = model.mesh.length === 0;
  select.addEventListener('change', () => onChoice(Number(select.value)));
  return (level: number) => (select.value = String(level));
}
