// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "pcavr/identification/signals.hpp"

namespace pcavr {

/// The force at which a sensor saturates, as find_saturation() finds it, but sample by sample: a
/// search in all stored samples takes a millisecond of a live cycle. Not thread-safe.
class ForceCeiling {
 public:
  explicit ForceCeiling(const SaturationOptions& options = {}) : options_(options) {}

  /// `force_base` [N] as measured, with spikes.
  void add(const Eigen::Vector3d& force_base);
  void clear() { *this = ForceCeiling(options_); }
  /// [N] The smallest extreme of an axis that was measured min_samples times in a row and is far
  /// above the axis' `noise` [N]; empty: the sensor has not saturated.
  [[nodiscard]] std::optional<double> value(const Eigen::Vector3d& noise) const;

 private:
  /// Of one axis, upwards.
  struct Extreme {
    std::optional<double> value = {};  ///< [N]
    int run = 0;                       ///< newest samples that equal it
    int longest = 0;                   ///< run

    void add(double force);
  };

  SaturationOptions options_;
  std::array<Extreme, 3> highest_ = {};
  std::array<Extreme, 3> lowest_ = {};  ///< of the negative force
};

}  // namespace pcavr
