// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What a rigid body does in an engine: the same experiments in all of them (see engines.py, which makes the jobs).
import { readFileSync } from "node:fs";

/** The row's place in a table [t, ...], and its columns between two rows. */
function tableReader(table) {
  let k = 0;
  return (t) => {
    while (k + 2 < table.length && table[k + 1][0] <= t) ++k;
    const [a, b] = [table[k], table[Math.min(k + 1, table.length - 1)]];
    const s = b[0] > a[0] ? Math.min(1, Math.max(0, (t - a[0]) / (b[0] - a[0]))) : 0;
    return a.map((value, i) => value + s * (b[i] - value));
  };
}

/**
 * Rows [t, x, y, z, yaw, vx, vy, wz, fx, fy, fz]: the body's origin [m] and heading [rad], the velocity of its
 * centre of mass, and the tool's force on it [N], base axes.
 * engine: step(), setTool(p, v), toolForce(), state() -> {position, quaternion xyzw, velocity, spin},
 * setVelocity(v, w), applyWrench(force, torque) about the centre of mass.
 */
export function runExperiment(engine, { dt, settle, duration, every, twist, wrench, tool }) {
  const away = [0, 0, 50];
  for (let t = 0; t < settle; t += dt) {
    engine.setTool(away, [0, 0, 0]);
    engine.step();
  }
  if (twist) engine.setVelocity([twist[0], twist[1], 0], [0, 0, twist[2]]);
  const toolAt = tool && tableReader(tool);
  const wrenchAt = wrench && tableReader(wrench);
  const rows = [];
  for (let step = 0; step * dt < duration; ++step) {
    const t = step * dt;
    if (toolAt) {
      const row = toolAt(t);
      engine.setTool(row.slice(1, 4), row.slice(4, 7));
    } else {
      engine.setTool(away, [0, 0, 0]);
    }
    if (wrenchAt) {
      const row = wrenchAt(t);
      engine.applyWrench(row.slice(1, 4), row.slice(4, 7));
    }
    engine.step();
    if (step % every) continue;
    const { position, quaternion: q, velocity, spin } = engine.state();
    const yaw = Math.atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
    rows.push([t, ...position, yaw, velocity[0], velocity[1], spin[2], ...engine.toolForce()]);
  }
  return rows;
}

/** Runs the jobs of a file, [{id, world, experiment, options}], and prints a line of JSON for each. */
export function runJobs(file, makeEngine) {
  for (const line of readFileSync(file, "utf8").trim().split("\n")) {
    const job = JSON.parse(line);
    const engine = makeEngine(job);
    console.log(JSON.stringify({ id: job.id, rows: runExperiment(engine, job.experiment) }));
    engine.delete();
  }
}

/** [kg] of the tool: contact does not move it, and its change of velocity in a step is the force. */
export const TOOL_MASS = 100;
