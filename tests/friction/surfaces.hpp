// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"

#include "physics/friction/quartic.hpp"
#include "physics/friction/ternary_form.hpp"

namespace pcavr {

inline Eigen::Vector3d random_vector(Random& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// A convex quartic that is no ellipsoid: an ellipsoid's and some fourth powers.
inline LimitSurface random_surface(Random& random) {
  LimitSurface surface =
      ellipsoid_surface(random.uniform(1.0, 40.0), random.uniform(0.05, 4.0),
                        Eigen::Vector2d(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)));
  for (int i = 0; i < 3; ++i) {
    const auto power = detail::TernaryForm<4>::power_of(random_vector(random));
    for (std::size_t k = 0; k < surface.coefficients.size(); ++k) {
      surface.coefficients[k] += 0.2 * power[static_cast<Eigen::Index>(k)];
    }
  }
  return surface;
}

}  // namespace pcavr
