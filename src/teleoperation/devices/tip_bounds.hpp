// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {

/// [m] from the base. Larger than any room that a depth camera records: beyond it, data is invalid.
inline constexpr double kMaxTipCoordinate = 100.0;

[[nodiscard]] inline bool is_plausible_tip(const Eigen::Vector3d& p_base) noexcept {
  return p_base.allFinite() && p_base.cwiseAbs().maxCoeff() <= kMaxTipCoordinate;
}

/// Whether it can be normalized to a rotation: its norm is neither close to zero nor too large.
[[nodiscard]] inline bool is_rotation(const Eigen::Quaterniond& q) noexcept {
  const double norm = q.norm();
  return std::isfinite(norm) && norm > 1e-3 && norm < 1e3;
}

/// `target`, moved towards `from` so that it is at most `max_distance` [m] away from it.
[[nodiscard]] inline Eigen::Vector3d limit_distance(const Eigen::Vector3d& from,
                                                    const Eigen::Vector3d& target,
                                                    double max_distance) noexcept {
  const Eigen::Vector3d displacement = target - from;
  const double length = displacement.norm();
  return length <= max_distance ? target
                                : Eigen::Vector3d(from + displacement * (max_distance / length));
}

}  // namespace pcavr
