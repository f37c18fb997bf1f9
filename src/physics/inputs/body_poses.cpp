// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/body_poses.hpp"

namespace pcavr {

Pose BodyPoses::at(std::size_t body, double t) const {
  if (is_tracked(body)) return pose_at(bodies_[body].tracked, t);
  const Pose& start = bodies_[body].T_base_object;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (const Step& step : steps_[body]) {
    if (step.t <= t) moved = step.total_base;
  }
  return Pose(start.rotation(), start.translation() + moved);
}

void BodyPoses::displace(std::size_t body, double t, const Eigen::Vector3d& displacement_base) {
  std::vector<Step>& steps = steps_[body];
  const Eigen::Vector3d before =
      steps.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : steps.back().total_base;
  // A body on its support keeps its height.
  steps.push_back({t, before + Eigen::Vector3d(displacement_base.x(), displacement_base.y(), 0.0)});
}

Touch BodyPoses::touch(std::size_t body, double t, const Eigen::Vector3d& p_base_tip,
                       double tool_radius) const {
  return surfaces_[body].touch(at(body, t), p_base_tip, tool_radius);
}

}  // namespace pcavr
