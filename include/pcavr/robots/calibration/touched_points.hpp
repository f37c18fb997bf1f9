// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A point whose place in a world is known, touched by the tip.
struct TouchedPoint {
  std::string name;
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();   ///< [m] the tip's centre
};

struct TouchedResidual {
  std::string name;
  Eigen::Vector3d error_base = Eigen::Vector3d::Zero();  ///< [m] touched less placed
};

struct TouchResult {
  Pose T_base_world = {};
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist [v; w] in the world's axes
  Eigen::Vector3d position_std = Eigen::Vector3d::Zero();  ///< [m] of the points' centre, base axes
  Eigen::Vector3d rotation_std = Eigen::Vector3d::Zero();  ///< [rad] about the base's axes
  Eigen::Vector3d centre_world = Eigen::Vector3d::Zero();  ///< [m] of the points
  double rms = 0.0;    ///< [m] per axis, what the residuals show of a touch
  double scale = 1.0;  ///< of lengths in base over lengths in world
  double scale_std = 0.0;
  std::vector<TouchedResidual> residuals = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// The world's pose in base by least squares of the points [Kabsch 1976; Umeyama 1991]. Standard
/// deviations are those of Student's distribution at one std, by the residuals' degrees of freedom.
/// An Error where the points lie on a line, about which the world may turn, and where they fit
/// only mirrored. Thread-safe.
[[nodiscard]] Expected<TouchResult> calibrate_touch(const std::vector<TouchedPoint>& points);

}  // namespace pcavr
