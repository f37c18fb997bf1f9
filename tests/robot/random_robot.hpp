// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Geometry>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr::test {

inline Eigen::Vector3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

inline Eigen::Quaterniond random_rotation(Random& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Quaterniond(q.normalized());
}

/// A few point masses: physically possible by construction.
inline RigidInertia random_inertia(Random& random, double size = 0.1) {
  RigidInertia sum;
  for (int i = 0; i < 6; ++i) {
    sum = sum + RigidInertia{random.uniform(0.1, 1.0), random_vector(random, size),
                             Eigen::Matrix3d::Zero()};
  }
  return sum;
}

struct RandomRobotOptions {
  std::size_t joints = 7;
  bool is_chain = true;
  bool has_prismatic = false;
  bool has_axis_aligned = false;  ///< right angles and axes as in real descriptions
};

/// A robot with random frames, axes and inertias, up to some 0.3 m a link.
inline RobotModel random_robot(Random& random, const RandomRobotOptions& options = {}) {
  RobotModel model;
  model.name = "random";
  model.links.push_back({"base", std::nullopt, {}, std::nullopt, {}, {}});
  for (std::size_t i = 0; i < options.joints; ++i) {
    RobotJoint joint;
    joint.name = "joint" + std::to_string(i);
    joint.child_link = "link" + std::to_string(i);
    if (options.has_prismatic && random.uniform() < 0.3) joint.kind = JointKind::kPrismatic;
    if (i > 0) joint.parent = i - 1;
    if (!options.is_chain && i > 0) {
      const auto parent = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(i + 1)));
      joint.parent = parent == i ? std::nullopt : std::optional(parent);
    }
    if (options.has_axis_aligned) {
      const double quarters = std::floor(random.uniform(-1.0, 3.0));
      const Eigen::AngleAxisd turn(0.5 * std::numbers::pi * quarters, Eigen::Vector3d::UnitX());
      joint.T_parent_joint = Pose(Eigen::Quaterniond(turn), random_vector(random, 0.3));
      joint.axis = Eigen::Vector3d::Zero();
      joint.axis[static_cast<int>(random.uniform(0.0, 3.0))] = random.uniform() < 0.5 ? 1.0 : -1.0;
    } else {
      joint.T_parent_joint = Pose(random_rotation(random), random_vector(random, 0.3));
      joint.axis = (random_rotation(random) * Eigen::Vector3d::UnitX()).normalized();
    }
    joint.limits = {-2.5, 2.5, 2.0, 100.0};
    joint.coordinate = i;
    joint.body = random_inertia(random);
    model.joints.push_back(joint);
    model.links.push_back({joint.child_link, i, {}, joint.body, {}, {}});
  }
  model.dof = options.joints;
  return model;
}

inline Eigen::VectorXd random_vector(Random& random, std::size_t size, double range) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(size));
  for (double& x : v) x = random.uniform(-range, range);
  return v;
}

}  // namespace pcavr::test
