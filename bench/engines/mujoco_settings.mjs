// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The settings with which an exported MJCF world is compared: edits of its text, and friction by slip speed.

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
  const weight = body.mass * 9.80665;
  return () => {
    const spin = Math.hypot(...[3, 4, 5].map((k) => data.qvel[dof + k]));
    const v = Math.hypot(data.qvel[dof], data.qvel[dof + 1], spin * body.friction_radius);
    const stribeck = body.stribeck_speed > 0 ? Math.exp(-((v / body.stribeck_speed) ** 2)) : v < 1e-3 ? 1 : 0;
    const mu = body.coulomb_friction + (body.viscous * v) / weight + (body.static_friction - body.coulomb_friction) * stribeck;
    for (const foot of feet) model.geom_friction[3 * foot.geom] = (foot.base * mu) / body.friction;
  };
}
