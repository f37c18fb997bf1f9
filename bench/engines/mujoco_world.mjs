// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Loads an exported MJCF world, unmodified, with npm's @mujoco/mujoco, and gives what judges read from it.
import { readFileSync, readdirSync, existsSync } from "node:fs";
import { join, resolve } from "node:path";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

/** The engine; `tools` is a folder with node_modules. */
export async function loadEngine(tools) {
  const require = createRequire(resolve(tools, "package.json"));
  const { default: load } = await import(pathToFileURL(require.resolve("@mujoco/mujoco")).href);
  return load();
}

/** The model of a folder with scene.xml and meshes/. `edit` may change the text, for comparisons. */
export function loadWorld(mujoco, folder, edit = (text) => text) {
  const vfs = new mujoco.MjVFS();
  if (existsSync(join(folder, "meshes"))) {
    for (const name of readdirSync(join(folder, "meshes"))) {
      vfs.addBuffer(`meshes/${name}`, new Uint8Array(readFileSync(join(folder, "meshes", name))));
    }
  }
  const text = edit(readFileSync(join(folder, "scene.xml"), "utf8"));
  const model = mujoco.MjModel.from_xml_string(text, vfs);
  const data = new mujoco.MjData(model);
  mujoco.mj_forward(model, data);
  return { model, data, text };
}

/** [N] Force of the geom `tip` on others, base axes: the sum over its contacts. */
export function forceOfGeom(mujoco, model, data, tip) {
  const sum = [0, 0, 0];
  const wrench = new mujoco.DoubleBuffer(6);
  const contacts = data.contact; // a copy, which is not collected: long motions would fill the memory
  for (let i = 0; i < data.ncon; ++i) {
    const contact = contacts.get(i);
    const isFirst = contact.geom1 === tip;
    if (isFirst || contact.geom2 === tip) {
      mujoco.mj_contactForce(model, data, i, wrench);
      const f = wrench.GetView();
      // Rows of the frame are its axes; x is the normal from geom1 to geom2; the force is on geom2.
      for (let k = 0; k < 3; ++k) {
        const value = contact.frame[k] * f[0] + contact.frame[3 + k] * f[1] + contact.frame[6 + k] * f[2];
        sum[k] += isFirst ? value : -value;
      }
    }
    contact.delete();
  }
  contacts.delete();
  wrench.delete();
  return sum;
}

/** Moves the tool: a function of position [m] and velocity [m/s] in base. */
export function toolMover(mujoco, model, data, tool) {
  const id = (type, name) => mujoco.mj_name2id(model, mujoco.mjtObj[type].value, name);
  const joints = ["_x", "_y", "_z"].map((axis) => id("mjOBJ_JOINT", tool + axis));
  const body = id("mjOBJ_BODY", tool);
  const home = Array.from(model.body_pos.slice(3 * body, 3 * body + 3));
  return (position, velocity) =>
    joints.forEach((joint, i) => {
      data.qpos[model.jnt_qposadr[joint]] = position[i] - home[i];
      data.qvel[model.jnt_dofadr[joint]] = velocity[i];
    });
}

/** The rows of a CSV file with a header, as numbers. */
export function readCsv(file) {
  const [head, ...rows] = readFileSync(file, "utf8").trim().split(/\r?\n/);
  const names = head.split(",").map((name) => name.trim());
  return rows.map((row) => Object.fromEntries(row.split(",").map((value, i) => [names[i], Number(value)])));
}

export const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.floor(sorted.length / 2)] : NaN;
};
