// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {

/// [m] from the base. No room that a depth camera saw is as large: what says so is broken.
inline constexpr double kFarthestTip = 100.0;

[[nodiscard]] inline bool is_plausible_tip(const Eigen::Vector3d& p_base) noexcept {
  return p_base.allFinite() && p_base.cwiseAbs().maxCoeff() <= kFarthestTip;
}

/// Whether it can be made a rotation: not all but zero, and not what single precision overflows at.
[[nodiscard]] inline bool is_rotation(const Eigen::Quaterniond& q) noexcept {
  const double norm = q.norm();
  return std::isfinite(norm) && norm > 1e-3 && norm < 1e3;
}

/// `aim`, or as far towards it from `from` as `most` [m] goes.
[[nodiscard]] inline Eigen::Vector3d within_reach(const Eigen::Vector3d& from,
                                                  const Eigen::Vector3d& aim,
                                                  double most) noexcept {
  const Eigen::Vector3d way = aim - from;
  const double length = way.norm();
  return length <= most ? aim : Eigen::Vector3d(from + way * (most / length));
}

}  // namespace pcavr
