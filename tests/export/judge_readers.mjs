// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What the readers of URDF and USD in npm make of a folder with scene.urdf and scene.usda, as JSON:
//   node judge_readers.mjs TOOLS FOLDER
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [tools, folder] = process.argv.slice(2);
const load = (file) => import(pathToFileURL(resolve(tools, "node_modules", file)).href);

/** By urdf-loader, which takes its parser of XML from the browser: here from linkedom. */
async function readUrdf() {
  globalThis.DOMParser = (await load("linkedom/esm/index.js")).DOMParser;
  globalThis.Document = class {};
  globalThis.Element = class {};
  const { default: URDFLoader } = await load("urdf-loader/src/URDFLoader.js");
  const loader = new URDFLoader();
  const meshes = [];
  loader.loadMeshCb = (path) => meshes.push(path);
  const robot = loader.parse(readFileSync(join(folder, "scene.urdf"), "utf8"), ".");
  const joints = Object.entries(robot.joints).map(([name, joint]) => {
    const { x, y, z, w } = joint.quaternion;
    return { name, type: joint.jointType, position: joint.position.toArray(), quaternion: [x, y, z, w] };
  });
  const links = Object.entries(robot.links).map(([name, link]) => ({ name, ...link.inertial }));
  return { links, joints, meshes };
}

/** By tinyusdz, which is built for browsers, and refuses to start where it finds node. */
async function readUsd() {
  const { default: start } = await load("tinyusdz/tinyusdz.js");
  const wasmBinary = readFileSync(resolve(tools, "node_modules/tinyusdz/tinyusdz.wasm"));
  const hidden = globalThis.process;
  globalThis.process = undefined;
  globalThis.window = {};
  const native = await start({ wasmBinary }).finally(() => (globalThis.process = hidden));
  const loader = new native.TinyUSDZLoaderNative();
  if (!loader.loadFromBinary(new Uint8Array(readFileSync(join(folder, "scene.usda"))), "scene.usda")) {
    return { error: String(loader.error()) };
  }
  const prims = [];
  const add = (node) => {
    // Row vectors: the last row is the translation.
    const matrix = Array.from(node.localMatrix);
    prims.push({ path: node.absPath, name: node.displayName, type: node.nodeType, matrix });
    node.children.forEach(add);
  };
  add(loader.getDefaultRootNode());
  const meshes = [];
  for (let i = 0; i < loader.numMeshes(); ++i) {
    const mesh = loader.getMesh(i);
    meshes.push({ path: mesh.absPath, points: mesh.points.length / 3, indices: mesh.faceVertexIndices.length });
  }
  return { prims, meshes };
}

console.log(JSON.stringify({ urdf: await readUrdf(), usd: await readUsd() }, null, 1));
