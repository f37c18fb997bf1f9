// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Loads an exported world in MuJoCo and prints, as JSON, what the engine makes of it:
//   node judge_mujoco.mjs TOOLS WORLD
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { forceOfGeom, loadEngine, loadWorld, toolMover } from "../../bench/engines/mujoco_world.mjs";

const [tools, folder] = process.argv.slice(2);
const mujoco = await loadEngine(tools);
const manifest = JSON.parse(readFileSync(join(folder, "export.json"), "utf8"));

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const rotate = (m, v) => [0, 1, 2].map((i) => m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2]);

/** [N m] about the vertical through the centre of mass, and [N]: what friction does to a body that moves with this twist. */
function slidingWrench(body, twist) {
  const { model, data } = loadWorld(mujoco, folder);
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, body);
  const dof = model.body_dofadr[id];
  toolMover(mujoco, model, data, manifest.tool)([10, 10, 10], [0, 0, 0]); // out of reach
  const turns = [];
  const forces = [];
  for (let step = 0; step < 400; ++step) {
    const matrix = Array.from(data.xmat.slice(9 * id, 9 * id + 9));
    const arm = [0, 1, 2].map((i) => data.xipos[3 * id + i] - data.xpos[3 * id + i]);
    // The velocity of the body's origin; MuJoCo's angular velocity is in the body's axes.
    const spin = [0, 0, twist[2]];
    const linear = cross(spin, arm.map((a) => -a));
    data.qvel[dof] = twist[0] + linear[0];
    data.qvel[dof + 1] = twist[1] + linear[1];
    for (let i = 0; i < 3; ++i) data.qvel[dof + 3 + i] = matrix[6 + i] * twist[2];
    mujoco.mj_step(model, data);
    if (step < 200) continue;
    const force = Array.from(data.qfrc_constraint.slice(dof, dof + 3));
    const torque = rotate(matrix, Array.from(data.qfrc_constraint.slice(dof + 3, dof + 6)));
    turns.push(torque[2] - cross(arm, force)[2]);
    forces.push(Math.hypot(force[0], force[1]));
  }
  const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
  const result = { torque: mean(turns), force: mean(forces) };
  data.delete();
  model.delete();
  return result;
}

/** The tip at rest on the body's top: depths [m] and forces [N] of the contact. */
function press(body, depth) {
  const { model, data } = loadWorld(mujoco, folder);
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, body);
  const tip = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM.value, manifest.tool + "_tip");
  const radius = model.geom_size[3 * tip];
  const geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM.value, body);
  const top = data.geom_xpos[3 * geom + 2] + topOf(model, data, geom);
  const start = Array.from(data.xipos.slice(3 * id, 3 * id + 3));
  const move = toolMover(mujoco, model, data, manifest.tool);
  const found = [];
  for (let step = 0; step < 1500; ++step) {
    move([start[0], start[1], top + radius - depth * Math.min(1, step / 500)], [0, 0, 0]);
    mujoco.mj_step(model, data);
  }
  for (let i = 0; i < data.ncon; ++i) {
    const contact = data.contact.get(i);
    if (contact.geom1 === tip || contact.geom2 === tip) found.push(-contact.dist);
    contact.delete();
  }
  const force = forceOfGeom(mujoco, model, data, tip);
  const result = { depth: found[0] ?? 0, force: Math.hypot(...force), contacts: found.length };
  data.delete();
  model.delete();
  return result;
}

function topOf(model, data, geom) {
  const mesh = model.geom_dataid[geom];
  const first = model.mesh_vertadr[mesh];
  let top = -Infinity;
  for (let v = first; v < first + model.mesh_vertnum[mesh]; ++v) {
    const p = Array.from(model.mesh_vert.slice(3 * v, 3 * v + 3));
    top = Math.max(top, rotate(Array.from(data.geom_xmat.slice(9 * geom, 9 * geom + 9)), p)[2]);
  }
  return top;
}

const { model, data } = loadWorld(mujoco, folder);
const result = { version: mujoco.mj_versionString(), bodies: [] };
for (let id = 1; id < model.nbody; ++id) {
  const name = model.body(id).name;
  const entry = {
    name,
    mass: model.body_mass[id],
    inertia: Array.from(model.body_inertia.slice(3 * id, 3 * id + 3)),
    position: Array.from(data.xpos.slice(3 * id, 3 * id + 3)),
    quaternion: Array.from(data.xquat.slice(4 * id, 4 * id + 4)),
    centre: Array.from(data.xipos.slice(3 * id, 3 * id + 3)),
  };
  const known = manifest.bodies.find((body) => body.name === name);
  if (known) {
    const radius = known.friction_radius;
    entry.turning = slidingWrench(name, [0, 0, 0.05 / radius]).torque;
    entry.sliding = [0, 60, 120].map((angle) => {
      const a = (angle * Math.PI) / 180;
      return slidingWrench(name, [0.05 * Math.cos(a), 0.05 * Math.sin(a), 0]).force;
    });
    entry.presses = known.press_depths.map((depth) => press(name, depth));
  }
  result.bodies.push(entry);
}
console.log(JSON.stringify(result, null, 1));
