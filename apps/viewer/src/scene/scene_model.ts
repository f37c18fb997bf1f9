// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { ArmModel } from './arm';
import { request } from '../page_files';
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
  texture: string | null; // path of its image; null: it is painted in one colour
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

/// `/api/scene.json`; poses are in base, a tag's pose in its object's frame if it has an object.
export interface SceneModel {
  name: string;
  protocol: number;
  up: Vector; // opposite to gravity, in base; (0, 0, 1) unless base is an arbitrary world frame
  mesh: MeshLevel[]; // finest first
  tiles: { path: string; tiles: number; bytes: number } | null; // in place of `mesh`
  cloud: { path: string; points: number; bytes: number } | null;
  occupancy: { path: string; cells: number; edge: number; bytes: number } | null;
  unseen_support: { path: string; triangles: number; bytes: number } | null;
  objects: SceneObject[];
  robot: ArmModel | null;
  tags: SceneTag[];
  support_planes: { outline: Vector[] }[];
  guards: { name: string; vertices_mm: number[]; triangles: number[] }[];
  cameras: { position: Vector; quaternion: Quaternion }[];
}

/// Whether there is a scan, in levels of detail or tiles.
export function hasScan({ mesh, tiles }: SceneModel): boolean {
  return mesh.length > 0 || tiles !== null;
}

/// Whether the base frame is a robot's: the world frame of a scan without bodies, tags and arm is none.
export function hasRobotBase({ objects, tags, robot }: SceneModel): boolean {
  return objects.length > 0 || tags.length > 0 || robot !== null;
}

export interface SessionInfo {
  protocol: number;
  version: string;
  paired: boolean;
  mode: 'live' | 'replay';
  scene: string;
  code_picture: boolean; // the server has a QR code for other devices
}

/// Fetches JSON; throws an Error with path and HTTP status.
export async function fetchJson<T>(path: string): Promise<T> {
  const response = await request(path);
  if (!response.ok) throw new Error(`${path}: HTTP status ${response.status}`);
  return (await response.json()) as T;
}

export async function fetchScene(): Promise<SceneModel> {
  const scene = await fetchJson<Partial<SceneModel>>('/api/scene.json');
  if (scene.protocol !== undefined && scene.protocol !== protocolVersion)
    throw new Error(`The scene has version ${scene.protocol}, this page ${protocolVersion}`);
  return {
    name: scene.name ?? '',
    protocol: protocolVersion,
    up: scene.up ?? [0, 0, 1],
    mesh: scene.mesh ?? [],
    tiles: scene.tiles ?? null,
    cloud: scene.cloud ?? null,
    occupancy: scene.occupancy ?? null,
    unseen_support: scene.unseen_support ?? null,
    objects: scene.objects ?? [],
    robot: scene.robot ?? null,
    tags: scene.tags ?? [],
    support_planes: scene.support_planes ?? [],
    guards: scene.guards ?? [],
    cameras: scene.cameras ?? [],
  };
}

/// Fetches a file; `onProgress` gets the size of each chunk received.
export async function fetchBytes(
  path: string,
  onProgress: (bytes: number) => void,
): Promise<ArrayBuffer> {
  const response = await request(path);
  if (!response.ok) throw new Error(`${path}: HTTP status ${response.status}`);
  if (!response.body) return response.arrayBuffer();
  const chunks: Uint8Array[] = [];
  let length = 0;
  const reader = response.body.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    chunks.push(part.value);
    length += part.value.length;
    onProgress(part.value.length);
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes.buffer;
}
