// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace pcavr {

struct ResidualSpectrum {
  std::vector<double> frequency;  ///< [Hz]
  std::vector<double> density;    ///< amplitude density, unit of the values / sqrt(Hz)
};

/// Averaged over neighbouring frequencies into at most 200 bands. `interval` [s]. Pure function.
[[nodiscard]] ResidualSpectrum residual_spectrum(const Eigen::VectorXd& values, double interval);

}  // namespace pcavr
