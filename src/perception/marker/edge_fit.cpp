// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/edge_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

using Parameters = Eigen::Matrix<double, 5, 1>;  // offset, slope, low, contrast, blur
using Information = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kMinSamples = 15;  // three for each parameter
constexpr double kMinContrast = 8.0;     // [grey]; twice the noise of a poor camera
constexpr double kEdgeHuber = 1.5;       // [standard deviations] 96 % efficiency
constexpr int kMaxEdgeIterations = 8;    // usually 4 from an initial error of half a pixel
constexpr double kMinStep = 1e-4;        // [px] convergence
/// Minimum blur: the pixel's own box filter has a std of 0.29 px. The maximum is the reach.
constexpr double kMinBlur = 0.25;  // [px]

struct Linearisation {
  double residual = 0.0;
  Parameters jacobian;
};

Linearisation linearise(const EdgeSample& sample, const Parameters& p) {
  const double u = (sample.across - p(0) - p(1) * sample.along) / p(4);
  const double step = 0.5 * std::erfc(-u / std::numbers::sqrt2);
  const double gaussian = p(3) * std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi) / p(4);
  Linearisation result;
  result.residual = p(2) + p(3) * step - sample.grey;
  result.jacobian << -gaussian, -gaussian * sample.along, 1.0, step, -gaussian * u;
  return result;
}

/// Initial guess: the grey levels of both sides, from the samples that lie clearly on them.
Parameters initial_guess(std::span<const EdgeSample> samples, double reach) {
  double sum[2] = {0.0, 0.0};
  int count[2] = {0, 0};
  for (const EdgeSample& sample : samples) {
    if (std::abs(sample.across) < 0.5 * reach) continue;
    const int side = sample.across > 0.0 ? 1 : 0;
    sum[side] += sample.grey;
    ++count[side];
  }
  const double low = sum[0] / std::max(count[0], 1);
  const double high = sum[1] / std::max(count[1], 1);
  Parameters guess;
  guess << 0.0, 0.0, low, high - low, 0.7;
  return guess;
}

/// Robust standard deviation from the median absolute residual (MAD).
double estimate_noise_std(std::vector<double>& magnitudes) {
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  constexpr double kQuantisation = 0.5;  // [grey] of 8 bits
  return std::max(kQuantisation, kStdOverMad * *middle);
}

}  // namespace

std::optional<EdgeFit> fit_edge(std::span<const EdgeSample> samples, double reach) {
  if (samples.size() < kMinSamples) return std::nullopt;
  Parameters p = initial_guess(samples, reach);
  Information information;
  double noise_std = 1e3;  // the first step weights all samples equally
  std::vector<double> magnitudes(samples.size());
  for (int iteration = 0; iteration < kMaxEdgeIterations; ++iteration) {
    if (std::abs(p(3)) < kMinContrast) return std::nullopt;
    information.setZero();
    Parameters right = Parameters::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Linearisation linearised = linearise(samples[i], p);
      magnitudes[i] = std::abs(linearised.residual);
      const double weight =
          magnitudes[i] <= kEdgeHuber * noise_std ? 1.0 : kEdgeHuber * noise_std / magnitudes[i];
      information += weight * linearised.jacobian * linearised.jacobian.transpose();
      right += weight * linearised.residual * linearised.jacobian;
    }
    noise_std = estimate_noise_std(magnitudes);
    const Parameters step = information.ldlt().solve(right);
    p -= step;
    if (!p.allFinite() || std::abs(p(0)) > reach) return std::nullopt;
    p(4) = std::clamp(p(4), kMinBlur, reach);
    // The second step is the first one with Huber weights.
    if (iteration > 1 && std::abs(step(0)) < kMinStep) break;
  }
  EdgeFit fit{p(0), p(1), {}};
  fit.covariance = information.inverse().topLeftCorner<2, 2>() * (noise_std * noise_std);
  if (!fit.covariance.allFinite()) return std::nullopt;
  return fit;
}

}  // namespace pcavr
