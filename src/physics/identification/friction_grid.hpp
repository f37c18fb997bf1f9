// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/friction_posterior.hpp"

namespace pcavr::detail {

/// Unknowns in closed form.
enum FrictionColumn { kCoulomb, kMass, kStribeck, kSize, kCompliance, kDamping, kColumns };
using Unknowns = Eigen::Matrix<double, kColumns, 1>;
using Information = Eigen::Matrix<double, kColumns, kColumns>;

/// A point of the grid over the other unknowns, with the log evidence there.
struct GridPoint {
  double viscous = 0.0;
  double between = 0.0;  ///< scatter from push to push, as a share
  double within = 0.0;   ///< from place to place
  double drift = 0.0;    ///< share of the variance from push to push that is a drift
  double log_weight = 0.0;
};

/// The posterior at one grid point: Gaussian in the other unknowns.
struct Conditional : GridPoint {
  Unknowns mean = Unknowns::Zero();
  Information covariance = Information::Zero();
};

/// Mean and variance of a linear function of the unknowns and B over the posterior.
struct PosteriorMoments {
  double mean = 0.0, variance = 0.0;
};

/// The posterior on the whole grid; without points where nothing explains the samples.
struct Posterior {
  std::vector<Conditional> grid;
  std::vector<double> weights;

  explicit Posterior(std::vector<Conditional> points) : grid(std::move(points)) {
    if (grid.empty()) return;
    double highest = grid.front().log_weight, sum = 0.0;
    for (const Conditional& point : grid) highest = std::max(highest, point.log_weight);
    for (const Conditional& point : grid) {
      weights.push_back(std::exp(point.log_weight - highest));
      sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
  }

  [[nodiscard]] const Conditional& best() const {
    const auto highest = std::max_element(weights.begin(), weights.end());
    return grid[static_cast<std::size_t>(highest - weights.begin())];
  }

  /// Moments of `by` . unknowns + by_viscous B.
  [[nodiscard]] PosteriorMoments of(const Unknowns& by, double by_viscous) const {
    PosteriorMoments result;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      result.mean += weights[i] * (by.dot(grid[i].mean) + by_viscous * grid[i].viscous);
    }
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double off = by.dot(grid[i].mean) + by_viscous * grid[i].viscous - result.mean;
      result.variance += weights[i] * (by.dot(grid[i].covariance * by) + off * off);
    }
    return result;
  }
};

struct FrictionGrid {
  Posterior posterior;
  double level = 0.0;      ///< [N] typical friction
  std::size_t pushes = 0;  ///< numbers of pushes, used or not
};

/// The posterior of friction on a grid of viscous friction and scatters: refined about what a first
/// pass finds, after samples that do not fit have been weighed down. At least one sample.
[[nodiscard]] FrictionGrid solve_friction_grid(std::span<const FrictionSample> samples,
                                               const FrictionPriors& priors);

}  // namespace pcavr::detail
