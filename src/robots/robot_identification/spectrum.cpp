// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/spectrum.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <unsupported/Eigen/FFT>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

Spectrum power_spectrum(const Eigen::VectorXd& values, double interval) {
  const Eigen::Index count = values.size();
  PCAVR_REQUIRE(count >= 2 && interval > 0.0, count, interval);
  // Zeros up to a power of two: prime lengths would take quadratic time.
  std::size_t length = 2;
  while (length < static_cast<std::size_t>(count)) length *= 2;
  std::vector<double> windowed(length, 0.0);
  const double mean = values.mean();
  double window_power = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double phase = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5);
    const double window = 0.5 - 0.5 * std::cos(phase / static_cast<double>(count));
    windowed[static_cast<std::size_t>(i)] = window * (values[i] - mean);
    window_power += window * window;
  }
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double> fft;
  fft.fwd(transform, windowed);
  Spectrum spectrum;
  spectrum.step = 1.0 / (interval * static_cast<double>(length));
  spectrum.power.resize(static_cast<Eigen::Index>(length / 2));
  const double scale = 2.0 / (window_power * static_cast<double>(length));
  for (std::size_t k = 0; k < length / 2; ++k) {
    spectrum.power[static_cast<Eigen::Index>(k)] = scale * std::norm(transform[k]);
  }
  return spectrum;
}

}  // namespace pcavr
