// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/** [m/s] At which the limit surface of a body of export.json slips: velocity [m/s], spin [rad/s]. */
export const slipSpeed = (body, velocity, spin) =>
  Math.hypot(velocity[0], velocity[1], Math.hypot(...spin) * body.friction_radius);

/** The identified friction coefficient of a body of export.json at a slip speed, over the exported one, as run.mjs has it. */
export function frictionShare(body, slip) {
  const rise = body.stribeck_speed > 0 ? Math.exp(-((slip / body.stribeck_speed) ** 2)) : Number(slip < 1e-3);
  const viscous = (body.viscous * slip) / (9.80665 * body.mass);
  return (body.coulomb_friction + viscous + (body.static_friction - body.coulomb_friction) * rise) / body.friction;
}
