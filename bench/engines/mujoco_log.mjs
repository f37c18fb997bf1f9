// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// node mujoco_log.mjs TOOLS WORLD LOG: plays an exported world's motion.csv in stock MuJoCo, and writes what a
// lab would log of it, as tables of LOG: robot.csv (the tip's pose), ft.csv (the force on the bodies), and
// BODY.csv of each movable body.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { forceOfGeom, loadEngine, loadWorld, readCsv, toolMover } from "./mujoco_world.mjs";

const [tools, folder, log] = process.argv.slice(2);
const forceStep = 0.002; // s between the samples of force and tool
const trackedStep = 0.01; // s between those of the bodies

const mujoco = await loadEngine(tools);
const { model, data } = loadWorld(mujoco, folder);
const world = JSON.parse(readFileSync(join(folder, "export.json"), "utf8"));
const motion = readCsv(join(folder, "motion.csv"));
const id = (type, name) => mujoco.mj_name2id(model, mujoco.mjtObj[type].value, name);
const tip = id("mjOBJ_GEOM", `${world.tool}_tip`);
const move = toolMover(mujoco, model, data, world.tool);
const bodies = world.bodies.map(({ name }) => ({ name, id: id("mjOBJ_BODY", name) }));

const at = (t, row) => {
  const [a, b] = [motion[row], motion[Math.min(row + 1, motion.length - 1)]];
  const share = b.t > a.t ? (t - a.t) / (b.t - a.t) : 0;
  return (key) => a[key] + share * (b[key] - a[key]);
};
const pose = "x,y,z,qx,qy,qz,qw";
const tables = { robot: [`t,${pose}`], ft: ["t,fx,fy,fz"] };
for (const { name } of bodies) tables[name] = [`t,${pose}`];

const dt = model.opt.timestep;
const every = (seconds) => Math.max(1, Math.round(seconds / dt));
let row = 0;
for (let step = 0; step * dt < motion.at(-1).t; ++step) {
  const t = step * dt;
  while (row + 1 < motion.length && motion[row + 1].t <= t) ++row;
  const value = at(t, row);
  move(["x", "y", "z"].map(value), ["vx", "vy", "vz"].map(value));
  if (step % every(forceStep) === 0) {
    mujoco.mj_forward(model, data);
    const force = forceOfGeom(mujoco, model, data, tip);
    tables.robot.push([t, ...["x", "y", "z", "qx", "qy", "qz", "qw"].map(value)].join(","));
    tables.ft.push([t, ...force].join(","));
  }
  if (step % every(trackedStep) === 0) {
    for (const { name, id: body } of bodies) {
      const p = Array.from(data.xpos.slice(3 * body, 3 * body + 3));
      const [w, x, y, z] = Array.from(data.xquat.slice(4 * body, 4 * body + 4));
      tables[name].push([t, ...p, x, y, z, w].join(","));
    }
  }
  mujoco.mj_step(model, data);
}
mkdirSync(log, { recursive: true });
for (const [name, rows] of Object.entries(tables)) writeFileSync(join(log, `${name}.csv`), rows.join("\n") + "\n");
