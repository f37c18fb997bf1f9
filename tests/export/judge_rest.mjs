// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Leaves an exported world alone in MuJoCo for a second, and prints how far its bodies went [m], and how fast they are:
//   node judge_rest.mjs TOOLS WORLD
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { loadEngine, loadWorld, toolMover } from "../../bench/engines/mujoco_world.mjs";

const [tools, folder] = process.argv.slice(2);
const mujoco = await loadEngine(tools);
const { bodies, tool } = JSON.parse(readFileSync(join(folder, "export.json"), "utf8"));
const { model, data } = loadWorld(mujoco, folder);
const move = toolMover(mujoco, model, data, tool);
const ids = bodies.map(({ name }) => mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, name));
const placeOf = (id) => Array.from(data.xpos.slice(3 * id, 3 * id + 3));
const start = ids.map(placeOf);
const farthest = ids.map(() => 0);
const away = (i) => Math.hypot(...placeOf(ids[i]).map((value, k) => value - start[i][k]));
for (let t = 0; t < 1; t += model.opt.timestep) {
  move([10, 10, 10], [0, 0, 0]); // out of reach
  mujoco.mj_step(model, data);
  ids.forEach((_, i) => (farthest[i] = Math.max(farthest[i], away(i))));
}
const speedOf = (id) => Math.hypot(...data.qvel.slice(model.body_dofadr[id], model.body_dofadr[id] + 3));
console.log(JSON.stringify(bodies.map(({ name }, i) => ({ name, farthest: farthest[i], speed: speedOf(ids[i]) })), null, 1));
