// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/write_export.hpp"

namespace pcavr {
namespace {

// Both runners set the feet's coefficients by slip speed, which engines have no parameter for.
constexpr char kNodeRunner[] =
    R"(// node run.mjs: plays motion.csv in scene.xml; prints t and the force of the tool's tip on bodies [N].
// Needs: npm install @mujoco/mujoco
import { readFileSync, readdirSync } from "node:fs";
import loadMujoco from "@mujoco/mujoco";
const mujoco = await loadMujoco();
const files = new mujoco.MjVFS();
for (const f of readdirSync("meshes")) files.addBuffer("meshes/" + f, new Uint8Array(readFileSync("meshes/" + f)));
const model = mujoco.MjModel.from_xml_string(readFileSync("scene.xml", "utf8"), files);
const data = new mujoco.MjData(model);
const { bodies, tool } = JSON.parse(readFileSync("export.json", "utf8"));
const id = (type, name) => mujoco.mj_name2id(model, mujoco.mjtObj["mjOBJ_" + type].value, name);
const feet = bodies.map((b) => Array.from({ length: b.feet }, (_, i) => id("GEOM", `${b.name}/foot_${i}`)));
const base = Array.from(model.geom_friction);
const rows = readFileSync("motion.csv", "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
const joints = ["_x", "_y", "_z"].map((axis) => id("JOINT", tool + axis));
const home = Array.from(model.body_pos.slice(3 * id("BODY", tool), 3 * id("BODY", tool) + 3));
const tip = id("GEOM", tool + "_tip"), wrench = new mujoco.DoubleBuffer(6);
for (let k = 0, step = 0, t = rows[0][0]; t < rows.at(-1)[0]; t += model.opt.timestep, ++step) {
  while (k + 2 < rows.length && rows[k + 1][0] <= t) ++k;
  const s = (t - rows[k][0]) / (rows[k + 1][0] - rows[k][0]);
  const between = (column) => rows[k][column] + s * (rows[k + 1][column] - rows[k][column]);
  joints.forEach((joint, i) => {
    data.qpos[model.jnt_qposadr[joint]] = between(1 + i) - home[i];
    data.qvel[model.jnt_dofadr[joint]] = between(8 + i);
  });
  bodies.forEach((b, n) => {
    const v = data.qvel.slice(model.body_dofadr[id("BODY", b.name)]);
    const slip = Math.hypot(v[0], v[1], b.friction_radius * Math.hypot(v[3], v[4], v[5]));
    const rise = b.stribeck_speed > 0 ? Math.exp(-((slip / b.stribeck_speed) ** 2)) : Number(slip < 1e-3);
    const mu = b.coulomb_friction + (b.viscous * slip) / (9.80665 * b.mass) + (b.static_friction - b.coulomb_friction) * rise;
    for (const foot of feet[n]) model.geom_friction[3 * foot] = (base[3 * foot] * mu) / b.friction;
  });
  mujoco.mj_step(model, data);
  let force = 0;
  const contacts = data.contact; // a copy, to be deleted
  for (let i = 0; i < data.ncon; ++i) {
    const contact = contacts.get(i);
    if (contact.geom1 === tip || contact.geom2 === tip) mujoco.mj_contactForce(model, data, i, wrench), (force = Math.hypot(...wrench.GetView().slice(0, 3)));
    contact.delete();
  }
  contacts.delete();
  if (step % 10 === 0) console.log(t.toFixed(3), force.toFixed(4));
}
)";

constexpr char kPythonRunner[] =
    R"(# python3 run.py: plays motion.csv in scene.xml; prints t and the force of the tool's tip on bodies [N].
# Needs: pip install mujoco numpy. Not run by pcavr's tests.
import json, math
import mujoco, numpy
model = mujoco.MjModel.from_xml_path("scene.xml")
data = mujoco.MjData(model)
world = json.load(open("export.json"))
base = model.geom_friction.copy()
rows = numpy.loadtxt("motion.csv", delimiter=",", skiprows=1)
tip = model.geom(world["tool"] + "_tip").id
home = model.body(world["tool"]).pos.copy()
wrench = numpy.zeros(6)
for step, t in enumerate(numpy.arange(rows[0, 0], rows[-1, 0], model.opt.timestep)):
    now = [numpy.interp(t, rows[:, 0], column) for column in rows.T]
    for i, axis in enumerate("xyz"):
        joint = data.joint(f"{world['tool']}_{axis}")
        joint.qpos[0] = now[1 + i] - home[i]
        joint.qvel[0] = now[8 + i]
    for body in world["bodies"]:
        v = data.joint(body["name"]).qvel
        slip = math.hypot(v[0], v[1], body["friction_radius"] * math.hypot(v[3], v[4], v[5]))
        vs = body["stribeck_speed"]
        rise = math.exp(-((slip / vs) ** 2)) if vs > 0 else float(slip < 1e-3)
        mu = body["coulomb_friction"] + body["viscous"] * slip / (9.80665 * body["mass"])
        mu += (body["static_friction"] - body["coulomb_friction"]) * rise
        for i in range(body["feet"]):
            foot = model.geom(f"{body['name']}/foot_{i}").id
            model.geom_friction[foot, 0] = base[foot, 0] * mu / body["friction"]
    mujoco.mj_step(model, data)
    force = 0.0
    for i in range(data.ncon):
        if tip in (data.contact[i].geom1, data.contact[i].geom2):
            mujoco.mj_contactForce(model, data, i, wrench)
            force = float(numpy.linalg.norm(wrench[:3]))
    if step % 10 == 0:
        print(f"{t:.3f} {force:.4f}")
)";

/// [s] Of the line fits that take the noise out of the recorded motion: 50 um at 500 Hz are 35 mm/s
/// as differences, which would break static friction at the tip, and 1 mm/s so.
constexpr double kMotionWindow = 0.04;

struct MotionState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// The value and the slope at the row `at` of a line through the rows from `first` to `last`.
MotionState fit_line(const std::vector<TimedPose>& rows, std::size_t first, std::size_t last,
                     std::size_t at) {
  const double count = static_cast<double>(last - first + 1);
  const auto time = [&](std::size_t i) { return to_seconds(rows[i].stamp - rows[at].stamp); };
  double mean_time = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i <= last; ++i) {
    mean_time += time(i) / count;
    mean += rows[i].pose.translation() / count;
  }
  double spread = 0.0;
  Eigen::Vector3d covariance = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i <= last; ++i) {
    const double t = time(i) - mean_time;
    spread += t * t;
    covariance += t * (rows[i].pose.translation() - mean);
  }
  if (!(spread > 0.0)) return {.position = mean};
  const Eigen::Vector3d velocity = covariance / spread;
  return {.position = mean - mean_time * velocity, .velocity = velocity};
}

/// Positions and velocities of the rows, each from those of the window about it, and from its
/// neighbours at least.
std::vector<MotionState> smoothed_motion(const std::vector<TimedPose>& rows) {
  std::vector<MotionState> states;
  states.reserve(rows.size());
  std::size_t first = 0, last = 0;
  const auto is_far = [&](std::size_t i, std::size_t j) {
    return to_seconds(rows[j].stamp - rows[i].stamp) > kMotionWindow / 2.0;
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    while (is_far(first, i)) ++first;
    while (last + 1 < rows.size() && !is_far(i, last + 1)) ++last;
    const std::size_t begin = std::min(first, i > 0 ? i - 1 : 0);
    const std::size_t end = std::max(last, std::min(i + 1, rows.size() - 1));
    states.push_back(fit_line(rows, begin, end, i));
  }
  return states;
}

}  // namespace

Expected<void> write_motion(const Trajectory& tool, const std::filesystem::path& folder) {
  std::string text = "t,x,y,z,qw,qx,qy,qz,vx,vy,vz\n";
  const std::vector<TimedPose>& rows = tool.poses();
  const std::vector<MotionState> states = smoothed_motion(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [p, v] = states[i];
    const Eigen::Quaterniond& q = rows[i].pose.rotation();
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n",
                        to_seconds(rows[i].stamp - rows.front().stamp), p.x(), p.y(), p.z(), q.w(),
                        q.x(), q.y(), q.z(), v.x(), v.y(), v.z());
  }
  return write_file(folder / "motion.csv", text);
}

Expected<void> write_mujoco_runners(const std::filesystem::path& folder) {
  if (auto written = write_file(folder / "run.mjs", kNodeRunner); !written) return written;
  return write_file(folder / "run.py", kPythonRunner);
}

}  // namespace pcavr
