// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr {

struct Spectrum {
  double step = 0.0;      ///< [Hz] between two entries; the first is at 0
  Eigen::VectorXd power;  ///< squared amplitude; sums to the mean square of the signal
};

/// The power spectrum by one discrete Fourier transform over all values, less their mean, under a
/// Hann window.
[[nodiscard]] Spectrum power_spectrum(const Eigen::VectorXd& values, double interval);

}  // namespace pcavr
