// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Loads an exported arm in MuJoCo, attached to a world as docs/export.md shows, and prints its joints and bodies:
//   node judge_robot.mjs TOOLS FOLDER
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { loadEngine } from "../../bench/engines/mujoco_world.mjs";

const [tools, folder] = process.argv.slice(2);
const mujoco = await loadEngine(tools);
const files = new mujoco.MjVFS();
files.addBuffer("robot.xml", new Uint8Array(readFileSync(join(folder, "robot.xml"))));
const world = `<mujoco><asset><model name="arm" file="robot.xml"/></asset><worldbody>
<frame pos="0 0 1"><attach model="arm" body="base" prefix="robot/"/></frame></worldbody></mujoco>`;
const model = mujoco.MjModel.from_xml_string(world, files);
const data = new mujoco.MjData(model);
mujoco.mj_forward(model, data);
const joints = [];
for (let i = 0; i < model.njnt; ++i) {
  const dof = model.jnt_dofadr[i];
  const body = model.jnt_bodyid[i];
  joints.push({
    name: model.jnt(i).name,
    damping: model.dof_damping[dof],
    friction: model.dof_frictionloss[dof],
    armature: model.dof_armature[dof],
    mass: model.body_mass[body],
    inertia: Array.from(model.body_inertia.slice(3 * body, 3 * body + 3)),
    centre: Array.from(model.body_ipos.slice(3 * body, 3 * body + 3)),
    range: Array.from(model.jnt_range.slice(2 * i, 2 * i + 2)),
  });
}
const sites = [];
for (let i = 0; i < model.nsite; ++i) {
  sites.push({ name: model.site(i).name, position: Array.from(data.site_xpos.slice(3 * i, 3 * i + 3)) });
}
console.log(JSON.stringify({ joints, sites, motors: model.nu, shapes: model.ngeom }, null, 1));
