// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { protocolVersion, type Quaternion, type Vector } from '../protocol';

export interface MeshLevel {
  path: string;
  triangles: number;
  bytes: number;
}

export interface SceneObject {
  name: string;
  path: string;
  bytes: number;
  position: Vector;
  quaternion: Quaternion;
  mass: number | null; // [kg]
  movable: boolean;
  evidence: string;
  parameters: Record<string, number>;
}

export interface SceneTag {
  family: string;
  id: number;
  size: number; // [m]
  object: string | null; // null: fixed in base
  position: Vector;
  quaternion: Quaternion;
}

/// `/api/scene.json`; poses map the thing to base, a tag's to its object where it has one.
export interface SceneModel {
  name: string;
  protocol: number;
  mesh: MeshLevel[]; // finest first
  cloud: { path: string; points: number; bytes: number } | null;
  occupancy: { path: string; cells: number; edge: number; bytes: number } | null;
  objects: SceneObject[];
  tags: SceneTag[];
  support_planes: { outline: Vector[] }[];
  cameras: { position: Vector; quaternion: Quaternion }[];
}

export interface SessionInfo {
  protocol: number;
  version: string;
  paired: boolean;
  mode: 'live' | 'replay';
  scene: string;
}

/// Fetches JSON; an Error says in words what is wrong.
export async function fetchJson<T>(path: string): Promise<T> {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: the server answers ${response.status}`);
  return (await response.json()) as T;
}

export async function fetchScene(): Promise<SceneModel> {
  const scene = await fetchJson<Partial<SceneModel>>('/api/scene.json');
  if (scene.protocol !== undefined && scene.protocol !== protocolVersion)
    throw new Error(`The scene is of version ${scene.protocol}, this page of ${protocolVersion}`);
  return {
    name: scene.name ?? '',
    protocol: protocolVersion,
    mesh: scene.mesh ?? [],
    cloud: scene.cloud ?? null,
    occupancy: scene.occupancy ?? null,
    objects: scene.objects ?? [],
    tags: scene.tags ?? [],
    support_planes: scene.support_planes ?? [],
    cameras: scene.cameras ?? [],
  };
}

/// Fetches a file and tells of every piece of it that has come, in bytes.
export async function fetchBytes(
  path: string,
  onProgress: (bytes: number) => void,
): Promise<ArrayBuffer> {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: the server answers ${response.status}`);
  if (!response.body) return response.arrayBuffer();
  const pieces: Uint8Array[] = [];
  let length = 0;
  const reader = response.body.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    pieces.push(part.value);
    length += part.value.length;
    onProgress(part.value.length);
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    bytes.set(piece, at);
    at += piece.length;
  }
  return bytes.buffer;
}
