// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  Matrix4,
  Quaternion,
  Vector3,
  type TypedArray,
} from 'three';

// The subset of glTF 2 that gltfpack and pcavr write: triangles with colours or a texture of their
// own file, optionally with meshopt compression. No skins or animations: a fraction of a general
// loader's size.

interface Accessor {
  bufferView?: number;
  byteOffset?: number;
  componentType: number;
  count: number;
  type: string;
  normalized?: boolean;
}
interface BufferView {
  buffer: number;
  byteOffset?: number;
  byteLength: number;
  byteStride?: number;
  extensions?: { EXT_meshopt_compression?: Compressed; KHR_meshopt_compression?: Compressed };
}
interface Compressed {
  byteOffset?: number;
  byteLength: number;
  byteStride: number;
  count: number;
  mode: string;
  filter?: string;
}
interface Primitive {
  attributes: Record<string, number>;
  indices?: number;
  material?: number;
  mode?: number;
}
interface Node {
  mesh?: number;
  children?: number[];
  matrix?: number[];
  translation?: [number, number, number];
  rotation?: [number, number, number, number];
  scale?: [number, number, number];
}
interface Material {
  pbrMetallicRoughness?: {
    baseColorFactor?: [number, number, number, number];
    baseColorTexture?: { index: number };
  };
}
interface Gltf {
  scene?: number;
  scenes?: { nodes?: number[] }[];
  nodes?: Node[];
  meshes?: { primitives: Primitive[] }[];
  materials?: Material[];
  accessors?: Accessor[];
  bufferViews?: BufferView[];
}

export interface GlbPart {
  geometry: BufferGeometry;
  matrix: Matrix4; // part to file
  color: Color | null; // of the material, linear
  hasTexture: boolean; // a file of its own: gltfpack drops its name
}

type ArrayMaker = new (buffer: ArrayBuffer, at: number, length: number) => TypedArray;
const arrayOf: Record<number, ArrayMaker> = {
  5120: Int8Array,
  5121: Uint8Array,
  5122: Int16Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
};
const numbersIn: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const attributeNames: Record<string, string> = {
  POSITION: 'position',
  NORMAL: 'normal',
  COLOR_0: 'color',
  TEXCOORD_0: 'uv',
};

/// The triangles of a binary glTF file; throws an Error for what can't be read.
export async function readGlb(file: ArrayBuffer): Promise<GlbPart[]> {
  const { gltf, binary } = splitChunks(file);
  const views = await decodeViews(gltf, binary);
  const parts: GlbPart[] = [];
  const visit = (index: number, parent: Matrix4) => {
    const node = gltf.nodes?.[index];
    if (!node) throw new Error('glTF: a node is missing');
    const matrix = parent.clone().multiply(nodeMatrix(node));
    for (const primitive of node.mesh === undefined
      ? []
      : (gltf.meshes?.[node.mesh].primitives ?? []))
      if ((primitive.mode ?? 4) === 4) parts.push(readPrimitive(gltf, views, primitive, matrix));
    node.children?.forEach((child) => visit(child, matrix));
  };
  gltf.scenes?.[gltf.scene ?? 0]?.nodes?.forEach((node) => visit(node, new Matrix4()));
  return parts;
}

function splitChunks(file: ArrayBuffer): { gltf: Gltf; binary: Uint8Array } {
  const view = new DataView(file);
  if (file.byteLength < 20 || view.getUint32(0, true) !== 0x46546c67)
    throw new Error('not a binary glTF file');
  const jsonLength = view.getUint32(12, true);
  const json = new TextDecoder().decode(new Uint8Array(file, 20, jsonLength));
  const at = 20 + jsonLength;
  const binary =
    file.byteLength > at + 8
      ? new Uint8Array(file, at + 8, view.getUint32(at, true))
      : new Uint8Array();
  return { gltf: JSON.parse(json) as Gltf, binary };
}

function compressionOf({ extensions }: BufferView): Compressed | undefined {
  return extensions?.EXT_meshopt_compression ?? extensions?.KHR_meshopt_compression;
}

/// Every buffer view as bytes of its own buffer, so that arrays of any type may start there.
async function decodeViews(gltf: Gltf, binary: Uint8Array): Promise<ArrayBuffer[]> {
  const bytesAt = (part: { byteOffset?: number; byteLength: number }) =>
    binary.slice(part.byteOffset ?? 0, (part.byteOffset ?? 0) + part.byteLength);
  const views = gltf.bufferViews ?? [];
  if (!views.some(compressionOf)) return views.map((view) => bytesAt(view).buffer);
  const { MeshoptDecoder } = await import('three/addons/libs/meshopt_decoder.module.js');
  await MeshoptDecoder.ready;
  return views.map((view) => {
    const packed = compressionOf(view);
    if (!packed) return bytesAt(view).buffer;
    const target = new Uint8Array(packed.count * packed.byteStride);
    const { count, byteStride, mode, filter } = packed;
    MeshoptDecoder.decodeGltfBuffer(target, count, byteStride, bytesAt(packed), mode, filter);
    return target.buffer;
  });
}

function nodeMatrix(node: Node): Matrix4 {
  if (node.matrix) return new Matrix4().fromArray(node.matrix);
  return new Matrix4().compose(
    new Vector3(...(node.translation ?? [0, 0, 0])),
    new Quaternion(...(node.rotation ?? [0, 0, 0, 1])),
    new Vector3(...(node.scale ?? [1, 1, 1])),
  );
}

function readPrimitive(
  gltf: Gltf,
  views: ArrayBuffer[],
  primitive: Primitive,
  matrix: Matrix4,
): GlbPart {
  const geometry = new BufferGeometry();
  for (const [name, index] of Object.entries(primitive.attributes)) {
    const attribute = attributeNames[name];
    if (attribute) geometry.setAttribute(attribute, readAccessor(gltf, views, index));
  }
  if (primitive.indices !== undefined)
    geometry.setIndex(readAccessor(gltf, views, primitive.indices) as BufferAttribute);
  if (!geometry.hasAttribute('normal')) geometry.computeVertexNormals();
  const surface = gltf.materials?.[primitive.material ?? -1]?.pbrMetallicRoughness;
  const factor = surface?.baseColorFactor ?? null;
  return {
    geometry,
    matrix,
    color: factor && new Color(factor[0], factor[1], factor[2]),
    hasTexture: surface?.baseColorTexture !== undefined,
  };
}

function readAccessor(
  gltf: Gltf,
  views: ArrayBuffer[],
  index: number,
): BufferAttribute | InterleavedBufferAttribute {
  const accessor = gltf.accessors?.[index];
  const view = gltf.bufferViews?.[accessor?.bufferView ?? -1];
  if (!accessor || !view) throw new Error(`glTF: accessor ${index} has no data`);
  const size = numbersIn[accessor.type];
  const maker = arrayOf[accessor.componentType];
  if (!size || !maker) throw new Error(`glTF: accessor ${index} is of an unknown type`);
  const data = views[accessor.bufferView!];
  const each = new maker(new ArrayBuffer(8), 0, 1).BYTES_PER_ELEMENT;
  const stride = view.byteStride ?? compressionOf(view)?.byteStride ?? 0;
  const at = accessor.byteOffset ?? 0;
  if (stride <= size * each)
    return new BufferAttribute(
      new maker(data, at, accessor.count * size),
      size,
      accessor.normalized,
    );
  const whole = new maker(data, 0, Math.floor(data.byteLength / each));
  const interleaved = new InterleavedBuffer(whole, stride / each);
  return new InterleavedBufferAttribute(interleaved, size, at / each, accessor.normalized);
}
