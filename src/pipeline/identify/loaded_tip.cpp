// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "loaded_tip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/transmissions.hpp"

#include "pipeline/robot/recorded_arm.hpp"

namespace pcavr {
namespace {

constexpr Duration kMaxTipGap(100'000'000);  // [ns] of the joints' log, as of a tool's log
constexpr std::size_t kComparedPoses = 200;  // of the tool, spread over the recording
/// [m] A controller computes the tool's pose from these joints: they differ by rounding and by the
/// time between two samples. A tracker's noise alone is larger.
constexpr double kSameTip = 2e-5;

/// [rad/(N m)] by coordinate: what is not known of the deflection, all of it and its own error.
Expected<Eigen::VectorXd> gear_compliance(const RecordedArm& arm, const LoadedTipOptions& options) {
  const RobotModel& model = arm.model;
  const Expected<std::vector<JointTransmission>> transmissions =
      parse_transmissions(arm.urdf, model.file);
  if (!transmissions) return transmissions.error();
  const auto stated = [&](const std::string& joint) -> std::optional<double> {
    for (const JointTransmission& transmission : *transmissions) {
      if (transmission.joint == joint) return transmission.gear_stiffness;
    }
    return std::nullopt;
  };
  const auto dof = static_cast<Eigen::Index>(model.dof);
  Eigen::VectorXd compliance = Eigen::VectorXd::Zero(dof);
  for (const std::size_t i : model.coordinate_joints()) {
    const RobotJoint& joint = model.joints[i];
    const auto k = static_cast<Eigen::Index>(joint.coordinate);
    if (const std::optional<double> stiffness = stated(joint.name)) {
      compliance[k] = std::hypot(1.0, options.gear_stiffness_std) / *stiffness;
    } else if (joint.limits.effort && *joint.limits.effort > 0.0) {
      compliance[k] = options.wind_up / *joint.limits.effort;
    }
  }
  return compliance;
}

/// The force at any time, without spikes: one of 35 N would count as 0.3 mm.
class TipForce {
 public:
  explicit TipForce(const Recording& recording) {
    const Stamp start = recording.tool.poses().front().stamp;
    std::vector<Eigen::Vector3d> raw;
    for (const WrenchSample& sample : recording.wrench) {
      t_.push_back(to_seconds(sample.stamp - start));
      raw.push_back(sample.force);
    }
    force_.resize(raw.size());
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double> clean = remove_spikes(axis_of(raw, axis)).values;
      for (std::size_t i = 0; i < clean.size(); ++i) force_[i][axis] = clean[i];
    }
  }
  /// [N], base axes, that the tip exerts; `t` [s] from the tool's first stamp.
  [[nodiscard]] Eigen::Vector3d at(double t) const { return PathView(t_, force_).at(t); }

 private:
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> force_;
};

/// Whether the tool's poses are those of the encoders.
bool is_from_joints(const std::vector<TimedPose>& tool, const RecordedArm& arm,
                    RobotDynamics& kinematics) {
  std::vector<double> distances;
  const std::size_t stride = std::max<std::size_t>(1, tool.size() / kComparedPoses);
  for (std::size_t i = 0; i < tool.size(); i += stride) {
    const auto q = arm.position_at(tool[i].stamp, kMaxTipGap);
    if (!q) continue;
    kinematics.forward_kinematics(*q);
    const Pose T_base_tip = arm.T_base_robot * kinematics.T_base_link(arm.tip);
    distances.push_back((T_base_tip.translation() - tool[i].pose.translation()).norm());
  }
  if (distances.empty()) return false;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle < kSameTip;
}

}  // namespace

Expected<std::vector<Eigen::Matrix3d>> tip_covariance(const Recording& recording,
                                                      const LoadedTipOptions& options) {
  std::vector<Eigen::Matrix3d> covariance;
  const bool has_all = recording.manifest.robot && !recording.joints.empty() &&
                       recording.wrench.size() > 1 && !recording.tool.empty();
  if (!has_all) return covariance;
  const Expected<std::optional<RecordedArm>> arm = read_recorded_joints(recording);
  if (!arm) return arm.error();
  const RecordedArm& joints = **arm;
  const Expected<Eigen::VectorXd> compliance = gear_compliance(joints, options);
  if (!compliance) return compliance.error();
  RobotDynamics kinematics(joints.model);
  const std::vector<TimedPose>& tool = recording.tool.poses();
  if (!is_from_joints(tool, joints, kinematics)) return covariance;
  const TipForce force(recording);
  const Eigen::Matrix3d R_base_robot = joints.T_base_robot.rotation().toRotationMatrix();
  Matrix6Xd jacobian(6, compliance->size());
  for (const TimedPose& sample : tool) {
    covariance.emplace_back(Eigen::Matrix3d::Zero());
    const auto q = joints.position_at(sample.stamp, kMaxTipGap);
    if (!q) continue;
    kinematics.jacobian(*q, joints.tip, jacobian);
    const Eigen::Matrix3Xd by_joint = R_base_robot * jacobian.topRows<3>();
    const Eigen::VectorXd torque =
        by_joint.transpose() * force.at(to_seconds(sample.stamp - tool.front().stamp));
    // All gears give way together: their deflections add up, the errors of their stiffness less so.
    const Eigen::Vector3d deflection = by_joint * compliance->cwiseProduct(torque);
    covariance.back() = deflection * deflection.transpose();
  }
  return covariance;
}

}  // namespace pcavr
