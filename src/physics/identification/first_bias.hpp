// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/path_view.hpp"

namespace pcavr {

/// Bias [N] of a force at each of its stamps, before its contacts are known. From the smallest of
/// the short-time means it is followed both ways, through what lies within `nearness` [N] of it, by
/// at most `max_drift` [N/s] and, as a cable pulls on the sensor, `max_cable_stiffness` [N/m] times
/// the tip's net displacement: a bias that changes by more than a contact's threshold is not taken
/// for one. `t` ascending, at least partly free of contact; `tip` in base [m].
[[nodiscard]] std::vector<Eigen::Vector3d> first_bias(std::span<const double> t,
                                                      std::span<const Eigen::Vector3d> force,
                                                      const PathView& tip, double nearness,
                                                      double max_drift, double max_cable_stiffness);

}  // namespace pcavr
