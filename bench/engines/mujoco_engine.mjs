// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// MuJoCo (npm @mujoco/mujoco): node mujoco_engine.mjs TOOLS JOBS
// options: setting, as in mujoco_settings.mjs; folder, of the exported MJCF world.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { runJobs } from "./experiment.mjs";
import { SETTINGS, frictionBySpeed } from "./mujoco_settings.mjs";
import { forceOfGeom, loadEngine, loadWorld, toolMover } from "./mujoco_world.mjs";

const [tools, jobs] = process.argv.slice(2);
const mujoco = await loadEngine(tools);

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const sum = (a, b) => a.map((value, i) => value + b[i]);
/** A row-major rotation, or its transpose, times a vector. */
const rotate = (m, v) => [0, 1, 2].map((i) => m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2]);
const rotateBack = (m, v) => [0, 1, 2].map((i) => m[i] * v[0] + m[3 + i] * v[1] + m[6 + i] * v[2]);

function makeEngine({ options }) {
  const manifest = JSON.parse(readFileSync(join(options.folder, "export.json"), "utf8"));
  const body = manifest.bodies[0];
  const { edit, bySpeed } = SETTINGS[options.setting];
  const { model, data } = loadWorld(mujoco, options.folder, (text) => edit(text, body));
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, body.name);
  const tip = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM.value, `${manifest.tool}_tip`);
  const dof = model.body_dofadr[id];
  const move = toolMover(mujoco, model, data, manifest.tool);
  const control = bySpeed ? frictionBySpeed(mujoco, model, data, body) : () => {};
  const slice = (array, width) => Array.from(array.slice(width * id, width * id + width));
  const arm = () => sum(slice(data.xipos, 3), slice(data.xpos, 3).map((x) => -x));
  const spin = () => rotate(slice(data.xmat, 9), Array.from(data.qvel.slice(dof + 3, dof + 6)));
  return {
    step() {
      control();
      mujoco.mj_step(model, data);
      for (let i = 0; i < 6; ++i) data.xfrc_applied[6 * id + i] = 0;
    },
    setTool: move,
    toolForce: () => forceOfGeom(mujoco, model, data, tip),
    state() {
      const [w, x, y, z] = slice(data.xquat, 4);
      const velocity = sum(Array.from(data.qvel.slice(dof, dof + 3)), cross(spin(), arm()));
      return { position: slice(data.xpos, 3), quaternion: [x, y, z, w], velocity, spin: spin() };
    },
    setVelocity(linear, angular) {
      // Of the body's origin; MuJoCo's angular velocity is in the body's axes.
      const origin = sum(linear, cross(angular, arm()).map((v) => -v));
      const local = rotateBack(slice(data.xmat, 9), angular);
      for (let i = 0; i < 3; ++i) {
        data.qvel[dof + i] = origin[i];
        data.qvel[dof + 3 + i] = local[i];
      }
    },
    applyWrench(force, torque) {
      [...force, ...torque].forEach((value, i) => (data.xfrc_applied[6 * id + i] = value));
    },
    delete() {
      data.delete();
      model.delete();
    },
  };
}

runJobs(jobs, makeEngine);
