// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { TilesRenderer } from '3d-tiles-renderer/three';
import { Mesh, type Camera, type Object3D, type WebGLRenderer } from 'three';
import type { App } from '../app';
import { tileLimits, type TileLimits } from '../budgets';

export interface TileStats {
  loaded: number; // tiles in memory
  visible: number; // tiles that are drawn
  triangles: number; // of these
  depth: number; // of the finest of these; the root has 0
  megabytes: number; // of the tiles in memory
  isComplete: boolean; // nothing is being loaded
}

interface DrawnTile {
  internal: { depth: number };
  engineData: { scene?: Object3D | null };
}

const unloadedFraction = 0.8; // of the memory: what is left after tiles out of use were dropped

/// A scan as 3D Tiles. Tiles in view are loaded, coarse ones first, and finer ones where the viewer is near; tiles out of
/// use are dropped when the memory is full. If what is in view does not fit, it stays coarser.
export class TileStream {
  private readonly tiles: TilesRenderer;
  private camera: Camera | null = null;

  /// `onChange`: other tiles are to be drawn.
  constructor(
    path: string,
    parent: Object3D,
    private readonly renderer: WebGLRenderer,
    { megabytes, pixels }: TileLimits,
    onChange: () => void,
    onFailure: (text: string) => void,
  ) {
    this.tiles = new TilesRenderer(path);
    this.tiles.errorTarget = pixels;
    this.tiles.lruCache.maxBytesSize = 1e6 * megabytes;
    this.tiles.lruCache.minBytesSize = unloadedFraction * 1e6 * megabytes;
    this.tiles.lruCache.minSize = 0;
    for (const event of ['needs-update', 'load-model', 'tile-visibility-change'] as const)
      this.tiles.addEventListener(event, onChange);
    this.tiles.addEventListener('load-error', ({ error, url }) =>
      onFailure(`${String(url)}: ${error.message}`),
    );
    parent.add(this.tiles.group);
  }

  /// Before each frame, with the camera that draws it.
  update(camera: Camera): void {
    if (this.camera !== camera) {
      if (this.camera) this.tiles.deleteCamera(this.camera);
      this.tiles.setCamera(camera);
      this.camera = camera;
    }
    camera.updateMatrixWorld();
    this.tiles.setResolutionFromRenderer(camera, this.renderer);
    this.tiles.update();
  }

  get stats(): TileStats {
    const drawn = [...this.tiles.visibleTiles] as unknown as DrawnTile[];
    const { itemSet, cachedBytes } = this.tiles.lruCache as unknown as {
      itemSet: Map<unknown, unknown>;
      cachedBytes: number;
    };
    return {
      loaded: itemSet.size,
      visible: drawn.length,
      triangles: drawn.reduce((sum, { engineData }) => sum + trianglesOf(engineData.scene), 0),
      depth: Math.max(0, ...drawn.map(({ internal }) => internal.depth)),
      megabytes: cachedBytes / 1e6,
      isComplete: this.tiles.loadProgress === 1,
    };
  }
}

function trianglesOf(scene?: Object3D | null): number {
  let triangles = 0;
  scene?.traverse((part) => {
    if (part instanceof Mesh) triangles += (part.geometry.index?.count ?? 0) / 3;
  });
  return triangles;
}

/// Streams the scan's tiles into its layer, before each frame that shows it.
export function streamTiles(
  app: App,
  path: string,
  onChange: () => void,
  onFailure: (text: string) => void,
): TileStream {
  const { layers } = app.view;
  const limits = tileLimits(app.isSoftwareRendered);
  const parent = layers.group('mesh');
  const stream = new TileStream(path, parent, app.renderer, limits, onChange, onFailure);
  app.onFrame(() => {
    const { xr } = app.renderer;
    if (layers.isShown('mesh')) stream.update(xr.isPresenting ? xr.getCamera() : app.camera);
  });
  return stream;
}
