// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/noise_tracker.hpp"

namespace pcavr {

/// The force at which a sensor saturates, as find_saturation() finds it, but sample by sample: a
/// search in all stored samples takes a millisecond of a live cycle. Not thread-safe.
class ForceCeiling {
 public:
  /// `prior_noise` [N]: std of one sample until it is measured.
  explicit ForceCeiling(double prior_noise, const SaturationOptions& options = {})
      : options_(options), noise_(prior_noise) {}

  /// `force_base` [N] as measured, with spikes.
  void add(const Eigen::Vector3d& force_base);
  /// Restarts with these samples alone, which were added before.
  void restart(std::span<const Eigen::Vector3d> force_base);
  /// [N] The smallest extreme of an axis that was measured min_samples times in a row and is far
  /// above the axis' noise; empty: the sensor has not saturated.
  [[nodiscard]] std::optional<double> value() const;

 private:
  /// Largest value along one axis.
  struct Extreme {
    std::optional<double> value = {};  ///< [N]
    int run = 0;                       ///< newest samples that equal it
    int longest = 0;                   ///< run

    void add(double force);
  };

  void add_extremes(const Eigen::Vector3d& force_base);
  [[nodiscard]] bool is_at_extreme() const;

  SaturationOptions options_;
  NoiseTracker noise_;  ///< of what is not saturated: that has none
  std::array<Extreme, 3> highest_ = {};
  std::array<Extreme, 3> lowest_ = {};  ///< of the negative force
};

}  // namespace pcavr
