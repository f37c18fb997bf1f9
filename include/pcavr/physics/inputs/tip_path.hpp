// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/input_options.hpp"

namespace pcavr {

/// A time interval with the reason why its data are not used.
struct UnusableInterval {
  double begin = 0.0, end = 0.0;  ///< [s]
  std::string reason = {};
};

/// The tip's path without outliers. Refers to the series that it was made from, which must outlive
/// it. Thread-safe to read.
struct TipPath {
  std::span<const double> t;                ///< [s]
  std::span<const Eigen::Vector3d> p_base;  ///< [m]
  double noise = 0.0;                       ///< [m] std of one sample, largest axis
  std::size_t outliers = 0;                 ///< samples that were rejected
  double first_outlier = 0.0;               ///< [s]
  std::vector<double> jumps = {};           ///< [s] at which the tip jumps and stays there
  std::vector<UnusableInterval> bad = {};   ///< around jumps and dropouts, in order of time

  TipPath() = default;
  TipPath(TipPath&&) = default;
  TipPath& operator=(TipPath&&) = default;
  TipPath(const TipPath&) = delete;
  TipPath& operator=(const TipPath&) = delete;
  ~TipPath() = default;

  /// Linear interpolation; constant before the first and after the last sample [m].
  [[nodiscard]] Eigen::Vector3d at(double time) const;

  /// Storage for the spans if samples were rejected; else empty.
  std::vector<double> kept_t = {};
  std::vector<Eigen::Vector3d> kept_p_base = {};
};

/// Rejects samples that no arm could have reached: spikes of single samples [Hampel filter], and
/// dropouts to a place from which the tip returns within max_dropout. A step to a place where the
/// tip stays is a jump; steps that the acceleration of a tip or an error of the stamps explains are
/// not: between two stamps that are closer than the mean interval, the tip may have moved for the
/// mean interval. Stamps ascend strictly.
[[nodiscard]] TipPath clean_tip_path(std::span<const double> t,
                                     std::span<const Eigen::Vector3d> p_base,
                                     const InputOptions& options);

}  // namespace pcavr
