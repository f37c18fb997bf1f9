// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A scene of many bodies: copies of the first one's body and tags, in a grid.
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const pitch = 0.3; // [m]
const columns = 8;
const place = (i) => [0.3 + pitch * Math.floor(i / columns), pitch * ((i % columns) - 3.5), 0.08];

/// The item of a YAML list that begins with `- name: NAME`, up to the next item or the list's end.
function itemOf(text, name) {
  const begin = text.indexOf(`  - name: ${name}\n`);
  const [end] = ['\n  - ', '\n\n'].map((mark) => text.indexOf(mark, begin)).sort((a, b) => a - b);
  return text.slice(begin, end + 1);
}

function writeManifest(folder, names) {
  const file = join(folder, 'scene.yaml');
  const text = readFileSync(file, 'utf8');
  const first = itemOf(text, 'box_1');
  const second = itemOf(text, 'box_2');
  const tags = [...text.matchAll(/^ {2}- \{family: .*, object: box_1, .*\n/gm)].map(([row]) => row);
  let id = 100;
  const bodies = names.map((name, i) =>
    first
      .replaceAll('box_1', name)
      .replace(/(pose|start): \{t: \[[^\]]*\]/g, `$1: {t: [${place(i)}]`),
  );
  const copies = names
    .slice(2)
    .flatMap((name) =>
      tags.map((row) => row.replace(/id: \d+/, `id: ${id++}`).replace('box_1', name)),
    );
  writeFileSync(
    file,
    text.replace(first + second, bodies.join('')).replace(/^tags:\n/m, `tags:\n${copies.join('')}`),
  );
}

/// Adds a node for each further body to the scene's display file.
function writeNodes(folder, names) {
  const file = join(folder, 'scene.glb');
  const bytes = readFileSync(file);
  const length = bytes.readUInt32LE(12);
  const gltf = JSON.parse(bytes.toString('utf8', 20, 20 + length));
  const at = gltf.nodes.findIndex(({ name }) => name === 'box_1');
  const parent = gltf.nodes.find(({ children }) => children?.includes(at));
  for (const [i, name] of names.entries()) {
    if (gltf.nodes.some((node) => node.name === name)) continue;
    parent.children.push(gltf.nodes.length);
    gltf.nodes.push({ ...gltf.nodes[at], name, translation: place(i) });
  }
  let json = Buffer.from(JSON.stringify(gltf));
  json = Buffer.concat([json, Buffer.alloc(-json.length & 3, ' ')]);
  const head = Buffer.alloc(20);
  bytes.copy(head, 0, 0, 20);
  head.writeUInt32LE(bytes.length - length + json.length, 8);
  head.writeUInt32LE(json.length, 12);
  writeFileSync(file, Buffer.concat([head, json, bytes.subarray(20 + length)]));
}

/// Changes the folder of a scene with box_1 and box_2 to a scene of `count` bodies.
export function multiplyBodies(scene, count) {
  const names = Array.from({ length: count }, (_, i) => `box_${i + 1}`);
  for (const name of names.slice(2))
    copyFileSync(join(scene, 'objects/box_1.glb'), join(scene, `objects/${name}.glb`));
  writeManifest(scene, names);
  writeNodes(scene, names);
}
