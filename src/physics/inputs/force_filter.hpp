// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/segmentation.hpp"

#include "physics/inputs/filter_kinds.hpp"

namespace pcavr {

/// A low pass that the force has been through before it was recorded: a moving average, a
/// Butterworth filter, or a recursion without zeros, before which a sample is
///     (y_k - sum a_i y_(k-i)) / (1 - sum a_i).
struct ForceFilter {
  std::vector<double> coefficients = {};  ///< a_1, a_2, ... of the recursion
  double delay = 0.0;                     ///< [s] of slow changes
  double std = 0.0;                       ///< [s] of the delay
  double interval = 0.0;                  ///< [s] between the samples
  std::size_t average = 0;                ///< [samples] of a moving average
  std::optional<Butterworth> butterworth = {};
};

/// "a moving average of 25 samples".
[[nodiscard]] std::string kind_of(const ForceFilter& filter);

struct FilterFinding {
  std::optional<ForceFilter> filter = {};
  bool is_of_unknown_kind = false;  ///< the noise is that behind a filter, which no kind explains
};

/// The low pass by the noise of the force without contact: the sensor's own is white, so that one
/// that is correlated from sample to sample, and white again behind the inverse of an
/// autoregression, shows the filter [Yule-Walker]; that of moving averages and Butterworth filters
/// is known (filter_kinds). Slow drift is no filter. Empty where there is
/// none, and where the noise does not show it: too few samples, repeated or rounded ones,
/// vibrations.
[[nodiscard]] FilterFinding find_force_filter(std::span<const double> t,
                                              std::span<const Eigen::Vector3d> force,
                                              const Segmentation& found);

/// The same of another delay [s]: of second order nearly that; empty for higher orders.
[[nodiscard]] std::optional<ForceFilter> filter_with_delay(const ForceFilter& filter, double delay,
                                                           double std);

/// The force before the filter; after a gap in `t` [s] as recorded until the filter's memory is
/// full.
[[nodiscard]] std::vector<Eigen::Vector3d> without_filter(const ForceFilter& filter,
                                                          std::span<const double> t,
                                                          std::span<const Eigen::Vector3d> force);

}  // namespace pcavr
