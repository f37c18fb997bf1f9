// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What others' tools say of a folder with 3D Tiles, as JSON: 3d-tiles-tools packs and unpacks all of it, and
// Khronos's validator checks each tile.
//   node judge_tiles.mjs TOOLS FOLDER
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [tools, folder] = process.argv.slice(2);
const { validateBytes } = createRequire(join(tools, "node_modules/"))("gltf-validator");
const bin = join(tools, "node_modules/.bin/3d-tiles-tools");
const packed = join(tools, "tiles.3tz");
const unpacked = join(tools, "unpacked");
for (const [from, to] of [[join(folder, "tileset.json"), packed], [packed, unpacked]]) {
  execFileSync(bin, ["convert", "-i", from, "-o", to, "-f"], { stdio: "pipe" });
}

const names = readdirSync(join(folder, "tiles"));
const result = { tiles: names.length, unpacked: readdirSync(join(unpacked, "tiles")).length, errors: [], warnings: [] };
for (const name of names) {
  const { issues } = await validateBytes(new Uint8Array(readFileSync(join(folder, "tiles", name))));
  for (const { severity, code, pointer } of issues.messages) {
    if (severity === 0) result.errors.push(`${name}: ${code} ${pointer}`);
    if (severity === 1) result.warnings.push(`${name}: ${code} ${pointer}`);
  }
}
const { root, asset } = JSON.parse(readFileSync(join(unpacked, "tileset.json"), "utf8"));
result.version = asset.version;
result.children = root.children.length;
console.log(JSON.stringify(result));
