// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The settings with which an exported MJCF world is compared: edits of its text, and friction by slip speed.
import { frictionShare, slipSpeed } from "./friction_law.mjs";

const plain = (text, friction) =>
  text
    .replace(/.*class="foot" name.*\n/g, "")
    .replace(/.*<pair .*\n/g, "")
    .replace(/ cone="elliptic" impratio="\d+"/, "")
    .replace(/friction="[^"]*" priority="1" solref="[^"]*" solimp="[^"]*"/g, friction);

/** edit: of the text of scene.xml, for a body of export.json. */
export const SETTINGS = {
  "engine's defaults": { edit: (text) => plain(text, ""), bySpeed: false },
  "mu alone": {
    edit: (text, body) => plain(text, `friction="${body.coulomb_friction} 0.005 0.0001" priority="1"`),
    bySpeed: false,
  },
  export: { edit: (text) => text, bySpeed: false },
  "export, by slip speed": { edit: (text) => text, bySpeed: true },
};

/** Sets the feet's coefficients by the identified law, as run.mjs does: a function to call before each step. */
export function frictionBySpeed(mujoco, model, data, body) {
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, body.name);
  const dof = model.body_dofadr[id];
  const feet = [];
  for (let i = 0; i < body.feet; ++i) {
    const geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM.value, `${body.name}/foot_${i}`);
    feet.push({ geom, base: model.geom_friction[3 * geom] });
  }
  return () => {
    const v = data.qvel.slice(dof, dof + 6);
    const share = frictionShare(body, slipSpeed(body, v.slice(0, 3), v.slice(3)));
    for (const foot of feet) model.geom_friction[3 * foot.geom] = foot.base * share;
  };
}
