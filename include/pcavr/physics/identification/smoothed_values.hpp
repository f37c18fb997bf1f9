// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

/// The results of smooth_at() and smooth() without the derivatives, in about half the time. Rate
/// and acceleration are 0.
[[nodiscard]] SmoothedSample smooth_value_at(std::span<const double> t,
                                             std::span<const double> values, double at,
                                             double half_width);
[[nodiscard]] std::vector<SmoothedSample> smooth_values(std::span<const double> t,
                                                        std::span<const double> values,
                                                        std::span<const double> at,
                                                        double half_width);
/// The smoothed value of each axis, as by smooth_value_at(); empty where the window is not full.
[[nodiscard]] std::optional<Eigen::Vector3d> smooth_point_at(
    std::span<const double> t, std::span<const Eigen::Vector3d> points, double at,
    double half_width);

}  // namespace pcavr
