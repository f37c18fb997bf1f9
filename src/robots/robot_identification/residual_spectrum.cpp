// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/residual_spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "robots/robot_identification/spectrum.hpp"

namespace pcavr {

ResidualSpectrum residual_spectrum(const Eigen::VectorXd& values, double interval) {
  constexpr Eigen::Index kMaxBands = 200;
  const Spectrum spectrum = power_spectrum(values, interval);
  const Eigen::Index count = spectrum.power.size();
  const Eigen::Index width = std::max<Eigen::Index>(1, (count + kMaxBands - 1) / kMaxBands);
  ResidualSpectrum result;
  for (Eigen::Index first = 0; first < count; first += width) {
    const Eigen::Index used = std::min(width, count - first);
    const double power = spectrum.power.segment(first, used).mean();
    result.frequency.push_back(spectrum.step *
                               (static_cast<double>(first) + 0.5 * static_cast<double>(used - 1)));
    result.density.push_back(std::sqrt(power / spectrum.step));
  }
  return result;
}

}  // namespace pcavr
