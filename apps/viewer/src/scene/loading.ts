// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Group, Material, Mesh, Texture } from 'three';
import { count } from '../ui/format';
import { readGlb, type GlbPart } from './glb';
import { fetchBytes, type MeshLevel } from './scene_model';
import { scanMesh } from './scan_mesh';
import { fetchTexture } from './scan_texture';
import type { SceneView } from './view';

export interface Progress {
  loaded: number; // [bytes]
  total: number;
  what: string;
}

/// The level of detail to show: the finest of at most `triangles`, or else the coarsest.
export function levelWithin(levels: readonly MeshLevel[], triangles: number): number {
  const index = levels.findIndex((level) => level.triangles <= triangles);
  return index >= 0 ? index : levels.length - 1;
}

const texturePath = '/scene/texture.jpg';

/// Loads the bodies and the scan's coarsest level first, then the finest level within the budget.
export class SceneLoader {
  level = -1; // of the scan shown now; -1: none
  objectsLoaded = 0;
  isComplete = false;
  failures: string[] = [];
  private requested = -1; // the last requested level
  private isChosen = false; // by the user
  private loaded = 0;
  private total = 0;
  private texture: Promise<Texture> | null = null;

  constructor(
    private readonly view: SceneView,
    private readonly onProgress: (progress: Progress) => void,
    private readonly onPart: () => void,
    private readonly onFailure: (text: string) => void,
  ) {}

  /// `triangles`: the scan's triangle budget on this device.
  async load(triangles: number): Promise<void> {
    const model = this.view.model!;
    const coarsest = model.mesh.length - 1;
    const last = levelWithin(model.mesh, triangles);
    const levels = coarsest < 0 ? [] : last === coarsest ? [last] : [coarsest, last];
    this.total =
      model.objects.reduce((sum, object) => sum + object.bytes, 0) +
      (model.robot?.links ?? []).reduce((sum, link) => sum + link.bytes, 0) +
      levels.reduce((sum, level) => sum + model.mesh[level].bytes, 0) +
      (model.unseen_support?.bytes ?? 0);
    await Promise.all([
      ...this.view.bodies.map((b) => this.loadBody(b)),
      ...(model.robot?.links ?? []).map((_, i) => this.loadLink(i)),
      this.showLevel(levels[0]),
      this.loadUnseenSupport(),
    ]);
    if (levels.length > 1 && !this.isChosen) await this.showLevel(levels[1]);
    this.isComplete = true;
    this.finish();
  }

  /// Shows the level that the user has selected.
  async choose(level: number): Promise<void> {
    this.isChosen = true;
    this.total += this.view.model!.mesh[level].bytes;
    await this.showLevel(level);
    this.finish();
  }

  /// Replaces the level shown; of several requests in flight, the last one is shown.
  private async showLevel(level: number | undefined): Promise<void> {
    if (level === undefined) return;
    this.requested = level;
    if (level === this.level) return;
    const { path, triangles } = this.view.model!.mesh[level];
    const what = `scan, ${count(triangles)} triangles`;
    await this.attempt(path, async () => {
      const parts = await readGlb(await fetchBytes(path, (bytes) => this.advance(bytes, what)));
      const maps = await Promise.all(
        parts.map(({ hasTexture }) => (hasTexture ? this.scanTexture() : null)),
      );
      if (level !== this.requested) return;
      this.replaceScan('mesh', parts, maps);
      this.level = level;
    });
  }

  /// The texture that all levels share, fetched once.
  private scanTexture(): Promise<Texture> {
    this.texture ??= this.countedTexture(texturePath, 'texture');
    return this.texture;
  }

  /// Its size is not known beforehand.
  private countedTexture(path: string, what: string): Promise<Texture> {
    return fetchTexture(path, (bytes) => {
      this.total += bytes;
      this.advance(bytes, what);
    });
  }

  private replaceScan(layer: 'mesh' | 'unseen', parts: GlbPart[], maps: (Texture | null)[]): void {
    const group: Group = this.view.layers.group(layer);
    const old = [...group.children] as Mesh[];
    for (const [i, part] of parts.entries()) group.add(scanMesh(part, maps[i] ?? null));
    for (const mesh of old) {
      group.remove(mesh);
      mesh.geometry.dispose();
      (mesh.material as Material).dispose();
    }
  }

  private async loadUnseenSupport(): Promise<void> {
    const file = this.view.model!.unseen_support;
    if (!file) return;
    await this.attempt(file.path, async () => {
      const onProgress = (bytes: number) => this.advance(bytes, 'support');
      const parts = await readGlb(await fetchBytes(file.path, onProgress));
      this.replaceScan('unseen', parts, []);
    });
  }

  private async loadBody(body: SceneView['bodies'][number]): Promise<void> {
    const { path, name, texture } = body.object;
    await this.attempt(path, async () => {
      const onProgress = (bytes: number) => this.advance(bytes, name);
      const parts = await readGlb(await fetchBytes(path, onProgress));
      const hasMap = texture !== null && parts.some(({ hasTexture }) => hasTexture);
      const map = hasMap ? await this.countedTexture(texture, name) : null;
      body.addParts(parts, map);
      ++this.objectsLoaded;
    });
  }

  private async loadLink(index: number): Promise<void> {
    const arm = this.view.arm!;
    const { path, name } = arm.model.links[index];
    if (path === null) return;
    await this.attempt(path, async () => {
      arm.addParts(
        index,
        await readGlb(await fetchBytes(path, (bytes) => this.advance(bytes, name))),
      );
    });
  }

  /// A file that fails to load is reported and left out; the rest is shown.
  private async attempt(path: string, action: () => Promise<void>): Promise<void> {
    try {
      await action();
    } catch (error) {
      const text = `${path}: ${error instanceof Error ? error.message : String(error)}`;
      this.failures.push(text);
      this.onFailure(text);
    }
    this.onPart();
  }

  private finish(): void {
    this.onProgress({ loaded: this.total, total: this.total, what: '' });
  }

  private advance(bytes: number, what: string): void {
    this.loaded = Math.min(this.loaded + bytes, this.total);
    this.onProgress({ loaded: this.loaded, total: this.total, what });
  }
}
