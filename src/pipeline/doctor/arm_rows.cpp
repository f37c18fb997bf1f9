// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "diagnosis_rows.hpp"
#include "pipeline/checks/segmented_force.hpp"
#include "pipeline/robot/recorded_arm.hpp"

namespace pcavr {
namespace {

constexpr char kGravity[] = "gravity of the tool by its orientation";
constexpr char kJoints[] = "joints.csv against tool.csv through the URDF";
constexpr double kToDegrees = 180.0 / std::numbers::pi;

/// [rad] In orientations closer together than this a weight and a bias look alike.
constexpr double kMinTilt = 20.0 / kToDegrees;
constexpr double kMaxLeftForce = 1.0;  ///< [N] as for the force at rest
/// The tool's own axes explain the force where they leave this share of what the base's leave.
constexpr double kClearlyBetterAxes = 0.5;
/// Of the samples: with fewer free ones all are taken, and have to fit.
constexpr double kMinFreeShare = 0.2;
/// [N] rms that a weight and a bias leave of a tool that is free.
constexpr double kMaxFreeRms = 0.5;
constexpr std::size_t kForceSamples = 2000, kJointSamples = 200;
constexpr std::size_t kMinSamplesOfTool = 20;

/// Of the arm's tip against tool.csv, after what is constant between them.
constexpr double kMaxTipError = 5e-3, kMaxTipTurn = 1.0 / kToDegrees;  // [m, rad]
constexpr double kMaxLag = 0.3, kLagStep = 0.01;                       // [s]
constexpr Duration kMaxJointGap = std::chrono::milliseconds(200);

/// The force at an orientation of the tool, nothing touching it.
struct FreeForce {
  Eigen::Matrix3d R_base_tool;
  Eigen::Vector3d force;  ///< [N] as recorded
};

std::vector<FreeForce> free_forces(const Recording& recording) {
  const SegmentedForce segmented = segment_force(recording);
  const std::vector<Eigen::Vector3d>& force = segmented.force;
  const auto touches = [&](double t) {
    return std::any_of(
        segmented.found.contacts.begin(), segmented.found.contacts.end(),
        [&](const auto& contact) { return t >= contact.t.front() && t <= contact.t.back(); });
  };
  std::vector<FreeForce> free, all;
  const std::size_t stride = std::max<std::size_t>(1, force.size() / kForceSamples);
  for (std::size_t i = 0; i < force.size(); i += stride) {
    const auto T_base_tool = recording.tool.at(recording.wrench[i].stamp);
    if (!T_base_tool) continue;
    all.push_back({T_base_tool->rotation_matrix(), force[i]});
    if (!touches(segmented.t[i])) free.push_back(all.back());
  }
  // A weight that turns with the tool looks like one long contact.
  const double share = static_cast<double>(free.size()) / static_cast<double>(all.size());
  return share < kMinFreeShare ? all : free;
}

/// [rad] The largest change of the vertical in the tool's axes: without one, a weight and a bias
/// look alike.
double largest_tilt(const std::vector<FreeForce>& free) {
  const Eigen::Vector3d first = free.front().R_base_tool.row(2);
  double tilt = 0.0;
  for (const FreeForce& one : free) {
    const Eigen::Vector3d up = one.R_base_tool.row(2);
    tilt = std::max(tilt, std::atan2(first.cross(up).norm(), first.dot(up)));
  }
  return tilt;
}

/// force = steady + R turning, in the axes that `in_tool_axes` says.
struct FreeForceFit {
  Eigen::Vector3d steady = Eigen::Vector3d::Zero();   ///< in the axes of the force [N]
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();  ///< in the other axes [N]
  double rms = 0.0;                                   ///< [N]
};

FreeForceFit fit_free_force(const std::vector<FreeForce>& free, bool in_tool_axes) {
  Matrix6d information = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double squares = 0.0;
  for (const FreeForce& one : free) {
    Eigen::Matrix<double, 3, 6> rows;
    const Eigen::Matrix3d R = one.R_base_tool;
    rows << Eigen::Matrix3d::Identity(), (in_tool_axes ? Eigen::Matrix3d(R.transpose()) : R);
    information += rows.transpose() * rows;
    right += rows.transpose() * one.force;
    squares += one.force.squaredNorm();
  }
  // What the turns do not separate, as along a single axis of them, is shared out evenly.
  constexpr double kSeparated = 1e-3;  // of the largest eigenvalue
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  const double least = kSeparated * solver.eigenvalues()[5];
  Vector6d solution = Vector6d::Zero();
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (solver.eigenvalues()[k] < least) continue;
    const Vector6d direction = solver.eigenvectors().col(k);
    solution += direction.dot(right) / solver.eigenvalues()[k] * direction;
  }
  const double left = std::max(0.0, squares - right.dot(solution));
  return {solution.head<3>(), solution.tail<3>(),
          std::sqrt(left / (3.0 * static_cast<double>(free.size())))};
}

std::string vector_text(const Eigen::Vector3d& force) {
  return fmt::format("{:.2f} N (x {:.2f}, y {:.2f}, z {:.2f})", force.norm(), force.x(), force.y(),
                     force.z());
}

DiagnosisRow gravity_row(const Recording& recording) {
  if (recording.tool.empty() || recording.wrench.empty()) {
    return unchecked(kGravity, recording.tool.empty() ? "no tool.csv" : "no wrench.csv");
  }
  const std::vector<FreeForce> free = free_forces(recording);
  if (free.size() < kMinSamplesOfTool) return unchecked(kGravity, "the tool is hardly ever free");
  const double turn = largest_tilt(free);
  if (turn < kMinTilt) {
    return unchecked(kGravity, fmt::format("the tool tilts by no more than {:.1f} degrees: "
                                           "a weight and a bias look alike",
                                           kToDegrees * turn));
  }
  const FreeForceFit base = fit_free_force(free, false), tool = fit_free_force(free, true);
  if (std::min(base.rms, tool.rms) > kMaxFreeRms) {
    return unchecked(kGravity, "the tool is hardly ever free of contact while it turns");
  }
  const Eigen::Vector3d& weight = base.steady;
  const std::string figure =
      fmt::format("over {:.0f} degrees {} keeps its direction in base, and {} turns with the tool",
                  kToDegrees * turn, vector_text(weight), vector_text(base.turning));
  if (tool.rms < kClearlyBetterAxes * base.rms && tool.turning.norm() > kMaxLeftForce) {
    return disagreement(kGravity,
                        fmt::format("a weight of {:.2f} N turns as if the force were in the tool's "
                                    "axes: {:.2f} N are left, {:.2f} N in the base's",
                                    tool.turning.norm(), tool.rms, base.rms),
                        "wrench.csv is in the sensor's axes: turn it into base's, and take the "
                        "tool's weight off (pcavr calibrate force)");
  }
  if (weight.norm() <= kMaxLeftForce && base.turning.norm() <= kMaxLeftForce) {
    return agreement(kGravity, figure);
  }
  return disagreement(
      kGravity, figure,
      weight.norm() > base.turning.norm()
          ? fmt::format(
                "the weight of a tool of {:.2f} kg was not taken off: pcavr calibrate force "
                "finds it",
                std::abs(weight.z()) / kStandardGravity)
          : "a bias of the sensor, which turns with it: set it to zero before recording");
}

/// What lies between the arm's tip and tool.csv where the joints' clock is `lag` [s] late.
std::vector<Pose> tip_to_tool(const Recording& recording, const RecordedArm& arm,
                              RobotDynamics& kinematics, double lag) {
  std::vector<Pose> offsets;
  const auto& poses = recording.tool.poses();
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / kJointSamples);
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    const auto q = arm.position_at(poses[i].stamp + duration_from_seconds(lag), kMaxJointGap);
    if (!q) continue;
    kinematics.forward_kinematics(*q);
    offsets.push_back((arm.T_base_robot * kinematics.T_base_link(arm.tip)).inverse() *
                      poses[i].pose);
  }
  return offsets;
}

struct OffsetScatter {
  Pose middle = {};
  double position = 0.0;  ///< [m] rms from the middle
  double rotation = 0.0;  ///< [rad]
};

OffsetScatter scatter_of(const std::vector<Pose>& offsets) {
  OffsetScatter scatter;
  scatter.middle = offsets[offsets.size() / 2];
  const auto count = static_cast<double>(offsets.size());
  for (int round = 0; round < 3; ++round) {
    Vector6d mean = Vector6d::Zero();
    for (const Pose& offset : offsets) mean += (scatter.middle.inverse() * offset).log() / count;
    scatter.middle = scatter.middle * Pose::exp(mean);
  }
  for (const Pose& offset : offsets) {
    const Vector6d error = (scatter.middle.inverse() * offset).log();
    scatter.position += error.head<3>().squaredNorm() / count;
    scatter.rotation += error.tail<3>().squaredNorm() / count;
  }
  scatter.position = std::sqrt(scatter.position);
  scatter.rotation = std::sqrt(scatter.rotation);
  return scatter;
}

/// [s] The lag of joints.csv by which they fit best, where it explains half of the scatter.
std::optional<double> lag_of(const Recording& recording, const RecordedArm& arm,
                             RobotDynamics& kinematics, const OffsetScatter& now) {
  std::optional<double> best;
  double least = 0.5 * now.position;
  for (double lag = -kMaxLag; lag <= kMaxLag; lag += kLagStep) {
    const std::vector<Pose> offsets = tip_to_tool(recording, arm, kinematics, lag);
    if (offsets.size() < kMinSamplesOfTool) continue;
    const double scatter = scatter_of(offsets).position;
    if (scatter >= least) continue;
    least = scatter;
    best = lag;
  }
  return best;
}

DiagnosisRow joints_row(const Recording& recording) {
  if (!recording.manifest.robot) return unchecked(kJoints, "recording.yaml names no URDF");
  if (recording.joints.empty() || recording.tool.empty()) {
    return unchecked(kJoints, recording.tool.empty() ? "no tool.csv" : "no joints.csv");
  }
  const auto arm = read_recorded_joints(recording);
  if (!arm) return unchecked(kJoints, "the URDF does not have these joints");
  RobotDynamics kinematics((*arm)->model);
  const std::vector<Pose> offsets = tip_to_tool(recording, **arm, kinematics, 0.0);
  if (offsets.size() < kMinSamplesOfTool) {
    return unchecked(kJoints, "their times overlap in too few poses");
  }
  const OffsetScatter scatter = scatter_of(offsets);
  const std::string figure =
      fmt::format("the tool is {:.3f} m from link {}, constant to {:.1f} mm and {:.2f} degrees rms",
                  scatter.middle.translation().norm(), (*arm)->model.links[(*arm)->tip].name,
                  1e3 * scatter.position, kToDegrees * scatter.rotation);
  if (scatter.position <= kMaxTipError && scatter.rotation <= kMaxTipTurn) {
    return agreement(kJoints, figure);
  }
  const auto lag = lag_of(recording, **arm, kinematics, scatter);
  return disagreement(
      kJoints, figure,
      lag ? fmt::format("joints.csv is {:.0f} ms {} than tool.csv: put both on one clock",
                        1e3 * std::abs(*lag), *lag > 0.0 ? "later" : "earlier")
          : "the URDF is of another arm, robot.pose or the unit of the joints is wrong, or "
            "tool.csv "
            "is not in base");
}

}  // namespace

std::vector<DiagnosisRow> arm_rows(const Recording& recording) {
  return {gravity_row(recording), joints_row(recording)};
}

}  // namespace pcavr
