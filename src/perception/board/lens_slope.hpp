// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/base/geometry/lens.hpp"

namespace pcavr {

/// Derivative of lens.distort(p) by a coefficient, where the model does not fold. `p` on the plane
/// z = 1. In closed form: a lens with another coefficient takes milliseconds to construct, as
/// where it folds is searched for.
[[nodiscard]] Eigen::Vector2d lens_slope(const LensDistortion& lens, const Eigen::Vector2d& p,
                                         int coefficient);

}  // namespace pcavr
