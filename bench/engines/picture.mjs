// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Draws an exported URDF world by three.js and its urdf-loader, in Chromium without a window:
//   npm install --no-package-lock --prefix TOOLS three@0.187.0 urdf-loader@0.13.1
//   node bench/engines/picture.mjs TOOLS WORLD PICTURE.png
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join, normalize, resolve } from "node:path";

const [tools, world, picture] = process.argv.slice(2);
const size = [800, 534];

const page = `<!doctype html><body style="margin:0">
<script type="importmap">{"imports": {"three": "/tools/three/build/three.module.js",
  "three/examples/jsm/": "/tools/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from "three";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";
import URDFLoader from "/tools/urdf-loader/src/URDFLoader.js";

const scene = new THREE.Scene();
scene.background = new THREE.Color(0xdde4ee);
scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 2));
const sun = new THREE.DirectionalLight(0xffffff, 1.5);
sun.position.set(2, -1, 3);
scene.add(sun);

const manager = new THREE.LoadingManager();
const loader = new URDFLoader(manager);
loader.loadMeshCb = (path, meshes, ...rest) => {
  const done = rest.find((each) => typeof each === "function");
  new OBJLoader(meshes).load(path, (object) => {
    object.traverse(({ isMesh, geometry, material }) => {
      if (isMesh && !geometry.attributes.color) material.color.set(0xd08030);
      if (isMesh) material.side = THREE.DoubleSide;
    });
    done(object);
  });
};
loader.load("/world/scene.urdf", (robot) => scene.add(robot));
manager.onLoad = () => {
  const box = new THREE.Box3(); // of the bodies that have a mass
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (object.isURDFVisual && object.parent.inertial.mass > 0) box.expandByObject(object);
  });
  const centre = box.getCenter(new THREE.Vector3());
  const camera = new THREE.PerspectiveCamera(45, ${size[0]} / ${size[1]}, 0.01, 20);
  camera.up.set(0, 0, 1);
  camera.position.copy(centre).add(new THREE.Vector3(0.55, -0.55, 0.5));
  camera.lookAt(centre);
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(${size});
  document.body.append(renderer.domElement);
  renderer.render(scene, camera);
};
</script></body>`;

const folders = { tools: resolve(tools, "node_modules"), world: resolve(world) };
const server = createServer((request, response) => {
  const [, folder, ...path] = normalize(decodeURIComponent(request.url)).split("/");
  if (!folder) return response.setHeader("content-type", "text/html").end(page);
  try {
    const type = path.at(-1).endsWith(".js") ? "text/javascript" : "text/plain";
    response.setHeader("content-type", type).end(readFileSync(join(folders[folder], ...path)));
  } catch {
    response.writeHead(404).end();
  }
});
server.listen(0, "127.0.0.1", () => draw(server.address().port).finally(() => server.close()));

async function draw(port) {
  const profile = mkdtempSync(join(tmpdir(), "pcavr-picture-"));
  const browser = spawn(process.env.PCAVR_CHROMIUM ?? "/usr/bin/chromium", [
    "--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist",
    `--user-data-dir=${profile}`, `--window-size=${size}`, "--virtual-time-budget=60000", `--screenshot=${resolve(picture)}`,
    `http://127.0.0.1:${port}/`,
  ], { stdio: ["ignore", "ignore", "pipe"] });
  let said = "";
  browser.stderr.on("data", (data) => (said += data));
  const code = await new Promise((done) => browser.on("close", done));
  rmSync(profile, { recursive: true, force: true });
  if (code !== 0 || !said.includes("bytes written to file")) {
    console.error(`the browser drew nothing: ${said.slice(-500)}`);
    process.exitCode = 1;
  }
}
