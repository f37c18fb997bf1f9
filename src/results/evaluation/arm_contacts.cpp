// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "arm_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/time_series.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "pooled_errors.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// The arm of a recording, with its logs.
struct LoggedArm {
  RobotModel model;
  JointLog log;
  std::size_t tip = 0;
  Pose T_base_robot;
  std::vector<WrenchSample> wrench;
};

Expected<std::optional<LoggedArm>> read_logged_arm(const fs::path& recording) {
  std::error_code ignored;
  const fs::path joints = recording / "joints.csv";
  if (recording.empty() || !fs::exists(joints, ignored)) return std::optional<LoggedArm>();
  const fs::path file = recording / "recording.yaml";
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Expected<Manifest> manifest = parse_manifest(*text, file.string());
  if (!manifest) return manifest.error();
  if (!manifest->robot) return std::optional<LoggedArm>();
  const Expected<RobotModel> model = read_urdf(recording / manifest->robot->urdf);
  if (!model) return model.error();
  const Expected<std::string> rows = read_file(joints);
  if (!rows) return rows.error();
  const auto log = parse_joint_log({.file = joints.string(), .text = *rows, .skip_bad = true});
  if (!log) return log.error();
  Expected<MatchedRobot> matched = match_joints(log->content, *model);
  if (!matched) return matched.error();
  LoggedArm arm{.model = std::move(matched->model),
                .log = reordered(log->content, matched->columns),
                .tip = 0,
                .T_base_robot = manifest->robot->T_base_robot,
                .wrench = {}};
  arm.tip = manifest->robot->tip ? arm.model.link_index(*manifest->robot->tip).value_or(0)
                                 : default_tip(arm.model);
  const fs::path forces = recording / "wrench.csv";
  const Expected<std::string> samples = read_file(forces);
  if (!samples) return samples.error();
  auto wrench = parse_wrench({.file = forces.string(), .text = *samples, .skip_bad = true});
  if (!wrench) return wrench.error();
  arm.wrench = std::move(wrench).value().content;
  return std::optional<LoggedArm>(std::move(arm));
}

/// Mean force about `peak` [N], in base axes.
Eigen::Vector3d mean_force(const std::vector<WrenchSample>& wrench, Stamp peak,
                           Duration half_width) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const WrenchSample& sample : wrench) {
    if (sample.stamp < peak + -half_width || sample.stamp > peak + half_width) continue;
    sum += sample.force;
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

/// The joint that the contact loads most.
std::optional<JointLoad> load_of(const LoggedArm& arm, const ContactPeak& contact,
                                 Duration half_width, RobotDynamics& kinematics) {
  const auto row = std::lower_bound(arm.log.stamps.begin(), arm.log.stamps.end(), contact.peak);
  if (row == arm.log.stamps.end()) return std::nullopt;
  const Eigen::Vector3d force = mean_force(arm.wrench, contact.peak, half_width);
  if (force.norm() == 0.0) return std::nullopt;
  Matrix6Xd jacobian(6, static_cast<Eigen::Index>(arm.model.dof));
  kinematics.jacobian(arm.log.position.row(row - arm.log.stamps.begin()).transpose(), arm.tip,
                      jacobian);
  const Eigen::Vector3d direction_robot =
      arm.T_base_robot.rotation().conjugate() * force.normalized();
  const Eigen::VectorXd lever = jacobian.topRows<3>().transpose() * direction_robot;
  Eigen::Index joint = 0;
  const double arm_length = lever.cwiseAbs().maxCoeff(&joint);
  const std::size_t index = arm.model.coordinate_joints()[static_cast<std::size_t>(joint)];
  return JointLoad{.joint = arm.model.joints[index].name,
                   .measured = arm_length * contact.measured,
                   .rendered = arm_length * contact.rendered};
}

std::vector<ContactPeak> peaks_by(const RunFindings& run, ContactTask task, bool is_soft) {
  std::vector<ContactPeak> chosen;
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      if (peak.task == task && is_soft_press(peak) == is_soft) chosen.push_back(peak);
    }
  }
  return chosen;
}

double relative_error(double rendered, double measured) {
  return std::abs(rendered - measured) / measured;
}

std::string mean_error(const std::vector<ContactPeak>& peaks) {
  std::vector<double> errors;
  for (const ContactPeak& peak : peaks) {
    errors.push_back(relative_error(peak.rendered, peak.measured));
  }
  return press_errors_text(errors);
}

/// "measured, rendered, difference".
std::string pair_text(double measured, double rendered, const std::string& unit) {
  return readable(measured) + ' ' + unit + ", " + readable(rendered) + ' ' + unit + ", " +
         readable(kPercent * relative_error(rendered, measured)) + " %";
}

}  // namespace

Expected<void> add_joint_loads(const fs::path& recording, const ForceErrorOptions& options,
                               RunFindings& run) {
  const Expected<std::optional<LoggedArm>> arm = read_logged_arm(recording);
  if (!arm) return arm.error();
  if (!*arm) return {};
  RobotDynamics kinematics((*arm)->model);
  const Duration half_width = duration_from_seconds(options.peak_half_width);
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      std::optional<JointLoad> load = load_of(**arm, peak, half_width, kinematics);
      if (!load) continue;
      load->object = object;
      load->begin = peak.begin;
      run.joint_loads.push_back(*std::move(load));
    }
  }
  return {};
}

void add_arm_rows(const RunFindings& run, ReportTable& table) {
  if (run.joint_loads.empty()) return;
  const auto add = [&](const char* what, const char* source, const char* published,
                       const std::string& ours) {
    table.rows.push_back({what, source, published, ours});
  };
  const std::vector<ContactPeak> presses = peaks_by(run, ContactTask::press, false);
  if (!presses.empty()) {
    add("relative error of a press's peak force, by the arm", "B, table 3", "1.85 ± 0.85 %",
        mean_error(presses));
  }
  const std::vector<ContactPeak> soft = peaks_by(run, ContactTask::press, true);
  if (!soft.empty()) {
    add("relative error of the peak force on a soft object, by the arm", "B, table 4",
        "2.24 % (GADM 2.75 %, HSMM 3.12 %)", mean_error(soft));
  }
  std::vector<ContactPeak> slotting = peaks_by(run, ContactTask::slotting, false);
  for (const ContactPeak& peak : peaks_by(run, ContactTask::slotting, true)) {
    slotting.push_back(peak);
  }
  if (!slotting.empty()) {
    const auto largest = std::max_element(
        slotting.begin(), slotting.end(),
        [](const ContactPeak& a, const ContactPeak& b) { return a.measured < b.measured; });
    add("peak force by the arm in a hole: real, virtual, difference", "B, hole slotting",
        "91.23 N, 93.27 N, 2.24 %", pair_text(largest->measured, largest->rendered, "N"));
  }
  const auto largest = std::max_element(
      run.joint_loads.begin(), run.joint_loads.end(),
      [](const JointLoad& a, const JointLoad& b) { return a.measured < b.measured; });
  add("largest torque of a contact at a joint: real, virtual, difference", "B, virtual robot",
      "not in the source",
      pair_text(largest->measured, largest->rendered, "N m") + ", " + largest->joint);
}

ReportTable joint_load_table(const RunFindings& run, Stamp origin) {
  ReportTable table{
      .title = "Torque of each contact at the arm's joints",
      .columns = {"contact", "joint", "measured (N m)", "rendered (N m)", "error (%)"},
      .is_folded = true};
  for (const JointLoad& load : run.joint_loads) {
    table.rows.push_back(
        {load.object + ", from " + fixed(to_seconds(load.begin - origin), 3) + " s", load.joint,
         readable(load.measured), readable(load.rendered),
         readable(kPercent * relative_error(load.rendered, load.measured))});
  }
  table.note =
      "At the joint that the contact loads most, by the arm's Jacobian: of the measured force, and "
      "of the rendered one along the same direction.";
  return table;
}

}  // namespace pcavr
