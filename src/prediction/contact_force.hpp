// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "pcavr/identification/sliding.hpp"

namespace pcavr::detail {

/// No arm that pushes things over a table exerts more [N]; a tip that is put inside a stiff body by
/// a jump would otherwise throw it away.
constexpr double kMaxForce = 2000.0;

/// A contact's force and how it grows.
struct ContactForce {
  double force = 0.0;      ///< [N], 0 to kMaxForce
  double stiffness = 0.0;  ///< by depth [N/m]
  double damping = 0.0;    ///< by its rate [N s/m]
};

/// d^n, without a power function where n is 1 or 1.5.
inline double power(double depth, double exponent) noexcept {
  if (exponent == 1.0) return depth;
  if (exponent == 1.5) return depth * std::sqrt(depth);
  return std::pow(depth, exponent);
}

/// stiffness d^n + damping d^n d' (n = 1: damping d'), never pulling; zero slopes where it is cut.
inline ContactForce contact_force(const Compliance& law, double depth, double rate) noexcept {
  if (!(depth > 0.0)) return {};
  const double raised = power(depth, law.exponent);
  const double elastic = law.stiffness * raised;
  const double damping = law.exponent == 1.0 ? law.damping : law.damping * raised;
  const double force = elastic + damping * rate;
  if (!(force > 0.0)) return {};
  if (force >= kMaxForce) return {kMaxForce, 0.0, 0.0};
  const double rising = law.exponent == 1.0 ? elastic : force;
  return {force, law.exponent * rising / depth, damping};
}

/// The depth [m] at which the law gives that force when at rest.
inline double depth_at(const Compliance& law, double force) noexcept {
  return std::pow(std::max(force, 0.0) / law.stiffness, 1.0 / law.exponent);
}

}  // namespace pcavr::detail
