// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "pcavr/physics/friction/limit_surface.hpp"

namespace pcavr::detail {

/// A quartic form at one point, in the surface's own units u.
struct QuarticValue {
  double value = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

[[nodiscard]] QuarticValue evaluate_quartic(const std::array<double, 15>& c,
                                            const Eigen::Vector3d& u) noexcept;

/// Units of a wrench: a wrench divided by them is u, and a twist multiplied by them over the force
/// is its conjugate.
[[nodiscard]] inline Eigen::Vector3d scale_of(const LimitSurface& surface) noexcept {
  return {surface.force, surface.force, surface.force * surface.length};
}

}  // namespace pcavr::detail
