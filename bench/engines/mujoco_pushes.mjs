// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Replays the recorded tool in MuJoCo, and compares the tool's force while the body slides with the measured one:
//   node mujoco_pushes.mjs TOOLS WORLD RECORDING
// WORLD is from pcavr export --to mjcf --motion RECORDING.
// Settings: the engine's defaults (friction 1), a conventional export (mu alone, on the body's own surface), the
// export unmodified, and the export with its coefficients set by slip speed.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { SETTINGS, frictionBySpeed } from "./mujoco_settings.mjs";
import { forceOfGeom, loadEngine, loadWorld, median, readCsv, toolMover } from "./mujoco_world.mjs";

const SLIDING_SPEED = 1e-3; // [m/s] of the tracked body: twice what a tracker's noise gives over WINDOW
const WINDOW = 0.4; // [s]
const BIAS_TIME = 0.5; // [s] without contact at the start
const MIN_FORCE_SHARE = 0.3; // of the maximum: the tool is in contact

function replay(mujoco, folder, manifest, tool, { edit, bySpeed }) {
  const body = manifest.bodies[0];
  const { model, data } = loadWorld(mujoco, folder, (text) => edit(text, body));
  const tip = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM.value, manifest.tool + "_tip");
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value, body.name);
  const control = bySpeed ? frictionBySpeed(mujoco, model, data, body) : () => {};
  const move = toolMover(mujoco, model, data, manifest.tool);
  const dt = model.opt.timestep;
  const rows = [];
  let k = 0;
  for (let t = tool[0].t; t < tool[tool.length - 1].t; t += dt) {
    while (k + 2 < tool.length && tool[k + 1].t <= t) ++k;
    const s = (t - tool[k].t) / (tool[k + 1].t - tool[k].t);
    const between = (column) => tool[k][column] + s * (tool[k + 1][column] - tool[k][column]);
    move(["x", "y", "z"].map(between), ["vx", "vy", "vz"].map(between));
    control();
    mujoco.mj_step(model, data);
    const f = forceOfGeom(mujoco, model, data, tip);
    rows.push({ t, force: Math.hypot(f[0], f[1]) });
  }
  const pose = Array.from(data.xpos.slice(3 * id, 3 * id + 3));
  const q = Array.from(data.xquat.slice(4 * id, 4 * id + 4));
  data.delete();
  model.delete();
  return { rows, pose, yaw: 2 * Math.atan2(q[3], q[0]) };
}

function readTum(file) {
  const rows = readFileSync(file, "utf8").trim().split("\n").filter((line) => !line.startsWith("#"));
  return rows.map((line) => line.trim().split(/\s+/).map(Number)).map((v) => ({ t: v[0], x: v[1], y: v[2], yaw: 2 * Math.atan2(v[6], v[7]) }));
}

/** Whether the tracked body slides, as a function of time. */
function slidingAt(track) {
  return (t) => {
    const a = track.findIndex((row) => row.t >= t - WINDOW / 2);
    const b = track.findIndex((row) => row.t >= t + WINDOW / 2);
    if (a < 0 || b < 0) return false;
    return Math.hypot(track[b].x - track[a].x, track[b].y - track[a].y) / (track[b].t - track[a].t) > SLIDING_SPEED;
  };
}

const arguments_ = process.argv.slice(2);
const [tools, folder, recording] = arguments_;
const mujoco = await loadEngine(tools);
const manifest = JSON.parse(readFileSync(join(folder, "export.json"), "utf8"));
// motion.csv has the tool's smoothed motion and velocity; its times are from the first row of tool.csv on.
const start = readCsv(join(recording, "tool.csv"))[0].t;
const tool = readCsv(join(folder, "motion.csv")).map((row) => ({ ...row, t: row.t + start }));
const wrench = readCsv(join(recording, "wrench.csv"));
const name = manifest.bodies[0].name;
const track = readTum(join(recording, "tracked/objects", name, "tracked.txt"));
const truth = join(recording, "truth/objects", name + ".txt");
const end = (existsSync(truth) ? readTum(truth) : track).at(-1);

const first = wrench.filter((row) => row.t < wrench[0].t + BIAS_TIME);
const bias = ["fx", "fy"].map((axis) => median(first.map((row) => row[axis])));
const measured = wrench.map((row) => ({ t: row.t, force: Math.hypot(row.fx - bias[0], row.fy - bias[1]) }));
// The 99th percentile: sensors have spikes.
const maxForce = measured.map((row) => row.force).sort((a, b) => a - b)[Math.floor(0.99 * measured.length)];
const slides = slidingAt(track);
const chosen = measured.filter((row, i) => i % 5 === 0 && row.force > MIN_FORCE_SHARE * maxForce && slides(row.t));
const wanted = median(chosen.map((row) => row.force));

const result = { recording, samples: chosen.length, measured: wanted };
for (const [setting, how] of Object.entries(SETTINGS)) {
  const { rows, pose, yaw } = replay(mujoco, folder, manifest, tool, how);
  const dt = rows[1].t - rows[0].t;
  const at = chosen.map((row) => rows[Math.min(rows.length - 1, Math.max(0, Math.round((row.t - rows[0].t) / dt)))].force);
  const force = median(at);
  const waveform = median(at.map((value, i) => Math.abs(value - chosen[i].force)));
  result[setting] = {
    force,
    error: force / wanted - 1,
    waveform: waveform / wanted,
    end_mm: 1e3 * Math.hypot(pose[0] - end.x, pose[1] - end.y),
    turn_deg: (Math.atan2(Math.sin(yaw - end.yaw), Math.cos(yaw - end.yaw)) * 180) / Math.PI,
  };
}
console.log(JSON.stringify(result, null, 1));
