// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/segmentation.hpp"

namespace pcavr {

/// [N] Uninterrupted series of one axis of the force without contact, less its bias.
using FreeRuns = std::vector<std::vector<double>>;

/// By axis.
[[nodiscard]] std::array<FreeRuns, 3> free_runs(std::span<const double> t,
                                                const Segmentation& found,
                                                std::span<const Eigen::Vector3d> force);

[[nodiscard]] double samples_of(const FreeRuns& runs);

/// Whether values of the axis are noise: many, and not rounded or held.
[[nodiscard]] bool is_noisy(const FreeRuns& runs);

/// What an autoregression does not predict: from the order's sample of each run on.
[[nodiscard]] FreeRuns innovations(const FreeRuns& runs, const std::vector<double>& coefficients);

/// [N] Robust.
[[nodiscard]] double std_of(const FreeRuns& runs);

/// Beyond so many stds a value is a spike.
inline constexpr double kSpikeStds = 4.0;

/// At lags 1 to `lags` [samples], without spikes.
[[nodiscard]] std::vector<double> correlations_of(const FreeRuns& runs, std::size_t lags);

/// Of a correlation of so many samples: it may be chance below.
[[nodiscard]] double correlation_limit(const FreeRuns& runs);

}  // namespace pcavr
