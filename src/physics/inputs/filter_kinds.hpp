// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "physics/inputs/free_noise.hpp"

namespace pcavr {

/// Low passes that white noise has gone through; all axes through the same one.

/// Of a moving average over n samples, y_k - y_(k-1) = (x_k - x_(k-n)) / n: its correlation is -1/2
/// at lag n, and 0 at all others. Empty where it is not so.
[[nodiscard]] std::optional<std::size_t> find_moving_average(const std::vector<FreeRuns>& axes);

/// A Butterworth low pass by the bilinear transform, as filter designs for sampled signals have it:
/// as many zeros at half the sampling rate as poles [Parks & Burrus, Digital Filter Design, 1987].
struct Butterworth {
  std::size_t order = 0;
  double cutoff = 0.0;  ///< [1/samples]

  /// a_1, a_2, ... of its recursion y_k = b (x_k + ...) + a_1 y_(k-1) + a_2 y_(k-2) + ...
  [[nodiscard]] std::vector<double> coefficients() const;
  [[nodiscard]] double delay() const;  ///< [samples] of slow changes
};

/// Behind its poles' inverse, the noise has the correlations of its zeros alone. Order and cutoff
/// by least squares over lags of 1 to 8; empty where none explains them.
[[nodiscard]] std::optional<Butterworth> find_butterworth(const std::vector<FreeRuns>& axes);

/// The signal before it, of uninterrupted samples. A moving average has lost what repeats in its
/// window: that is only known from how it changes, and is forgotten within a second.
[[nodiscard]] std::vector<Eigen::Vector3d> before_average(std::size_t samples, double interval,
                                                          std::span<const Eigen::Vector3d> values);
[[nodiscard]] std::vector<Eigen::Vector3d> before_recursion(
    const std::vector<double>& coefficients, std::span<const Eigen::Vector3d> values);
/// Near half the sampling rate, where the zeros have left nothing, it is not amplified.
[[nodiscard]] std::vector<Eigen::Vector3d> before_butterworth(
    const Butterworth& filter, std::span<const Eigen::Vector3d> values);

}  // namespace pcavr
