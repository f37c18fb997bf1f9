// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "marker/edge_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

namespace pcavr {
namespace {

using Parameters = Eigen::Matrix<double, 5, 1>;  // offset, slope, low, contrast, blur
using Information = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kMinSamples = 15;  // three for each parameter
constexpr double kMinContrast = 8.0;     // [grey]; twice the noise of a poor camera
constexpr double kEdgeHuber = 1.5;       // [deviations]
constexpr int kMaxEdgeIterations = 8;    // 4 are the rule from within half a pixel
constexpr double kConverged = 1e-4;      // [px]
/// A pixel is itself a square blur of 0.29 px, and no wider blur than the reach can be told.
constexpr double kSharpest = 0.25;  // [px]

struct Linearised {
  double residual = 0.0;
  Parameters gradient;
};

Linearised linearise(const EdgeSample& sample, const Parameters& p) {
  const double u = (sample.across - p(0) - p(1) * sample.along) / p(4);
  const double step = 0.5 * std::erfc(-u / std::numbers::sqrt2);
  const double bell = p(3) * std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi) / p(4);
  Linearised one;
  one.residual = p(2) + p(3) * step - sample.grey;
  one.gradient << -bell, -bell * sample.along, 1.0, step, -bell * u;
  return one;
}

/// Brightness of both sides, from the samples that lie clearly on them.
Parameters first_guess(std::span<const EdgeSample> samples, double reach) {
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

double noise_scale(std::vector<double>& sizes) {
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  constexpr double kQuantisation = 0.5;  // [grey]
  return std::max(kQuantisation, 1.4826 * *middle);
}

}  // namespace

std::optional<EdgeFit> fit_edge(std::span<const EdgeSample> samples, double reach) {
  if (samples.size() < kMinSamples) return std::nullopt;
  Parameters p = first_guess(samples, reach);
  Information information;
  double scale = 1e3;  // the first step weighs all alike
  std::vector<double> sizes(samples.size());
  for (int iteration = 0; iteration < kMaxEdgeIterations; ++iteration) {
    if (std::abs(p(3)) < kMinContrast) return std::nullopt;
    information.setZero();
    Parameters right = Parameters::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Linearised one = linearise(samples[i], p);
      sizes[i] = std::abs(one.residual);
      const double weight = sizes[i] <= kEdgeHuber * scale ? 1.0 : kEdgeHuber * scale / sizes[i];
      information += weight * one.gradient * one.gradient.transpose();
      right += weight * one.residual * one.gradient;
    }
    scale = noise_scale(sizes);
    const Parameters step = information.ldlt().solve(right);
    p -= step;
    if (!p.allFinite() || std::abs(p(0)) > reach) return std::nullopt;
    p(4) = std::clamp(p(4), kSharpest, reach);
    // The second step is the first with weights.
    if (iteration > 1 && std::abs(step(0)) < kConverged) break;
  }
  EdgeFit fit{p(0), p(1), {}};
  fit.covariance = information.inverse().topLeftCorner<2, 2>() * (scale * scale);
  if (!fit.covariance.allFinite()) return std::nullopt;
  return fit;
}

}  // namespace pcavr
