// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/friction_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/friction/stribeck.hpp"

#include "physics/identification/friction_grid.hpp"

namespace pcavr {
namespace {

using detail::Conditional;
using detail::FrictionGrid;
using detail::kCoulomb;
using detail::kMass;
using detail::kStribeck;
using detail::Posterior;
using detail::PosteriorMoments;
using detail::Unknowns;

constexpr double kMaxPosteriorMassStd = 0.1;  // as a share of the mass
constexpr double kSameSpeed = 1.25;    // pushes whose speeds are within this factor share a row
constexpr double kMinRowSpeed = 1e-4;  // [m/s]

IdentifiedParameter marginal_of(const PosteriorMoments& moments) {
  return {moments.mean, std::sqrt(std::max(moments.variance, 0.0)), false};
}

void set_covariance(const Posterior& posterior, FrictionPosterior& result) {
  const Unknowns units[2] = {Unknowns::Unit(kMass), Unknowns::Unit(kCoulomb)};
  const double means[3] = {result.mass.value, result.coulomb.value, result.viscous.value};
  for (std::size_t i = 0; i < posterior.grid.size(); ++i) {
    const Conditional& point = posterior.grid[i];
    Eigen::Vector3d off(units[0].dot(point.mean), units[1].dot(point.mean), point.viscous);
    off -= Eigen::Vector3d(means[0], means[1], means[2]);
    Eigen::Matrix3d one = off * off.transpose();
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) one(r, c) += units[r].dot(point.covariance * units[c]);
    }
    result.covariance += posterior.weights[i] * one;
  }
}

bool is_finite(const FrictionSample& sample) {
  return std::isfinite(sample.force) && std::isfinite(sample.speed) &&
         std::isfinite(sample.acceleration) && std::isfinite(sample.rotation_share) &&
         std::isfinite(sample.travel);
}

/// Share of its mass that an object's seems to differ by, where the contact is stiffer by one std
/// of its compliance: under a steady tip, all of the object's acceleration is the contact's
/// compression.
double mass_change(std::span<const FrictionSample> samples) {
  double products = 0.0, squares = 0.0;
  for (const FrictionSample& sample : samples) {
    if (sample.is_turning) continue;
    products += sample.acceleration * sample.acceleration_change;
    squares += std::pow(sample.acceleration, 2) - std::pow(sample.acceleration_std, 2);
  }
  return squares > 0.0 ? std::abs(products) / squares : 0.0;
}

/// The mass is not known better than the compliance that it goes with. By the slides alone it would
/// seem to be: how friction changes in the swing after the breakaway would separate them, if it
/// were known to a thousandth. So the slides don't narrow the compliance's prior here [a cut:
/// Plummer 2015, Cuts in Bayesian graphical models].
void widen_mass(std::span<const FrictionSample> samples, FrictionPosterior& result) {
  const double variance = result.covariance(0, 0);
  const double added = std::pow(mass_change(samples) * result.mass.value, 2) - variance;
  if (!(added > 0.0) || !(variance > 0.0)) return;
  const Eigen::Vector3d by = result.covariance.col(0) / variance;
  result.covariance += added * by * by.transpose();
  result.mass.std = std::sqrt(result.covariance(0, 0));
  result.coulomb.std = std::sqrt(result.covariance(1, 1));
  result.viscous.std = std::sqrt(result.covariance(2, 2));
}

/// One row for each speed at which pushes slid, where the force there is identified.
void set_forces(std::span<const FrictionSample> samples, const FrictionGrid& grid,
                const FrictionPriors& priors, FrictionPosterior& result) {
  std::vector<double> speeds;
  for (std::size_t push = 0; push < grid.pushes; ++push) {
    std::vector<double> of_push;
    for (const FrictionSample& sample : samples) {
      if (sample.push == push) of_push.push_back(sample.speed);
    }
    if (!of_push.empty()) speeds.push_back(std::max(median(of_push), kMinRowSpeed));
  }
  std::sort(speeds.begin(), speeds.end());
  for (std::size_t begin = 0, end; begin < speeds.size(); begin = end) {
    double sum = 0.0;
    for (end = begin; end < speeds.size() && speeds[end] <= kSameSpeed * speeds[begin]; ++end) {
      sum += speeds[end];
    }
    const double speed = sum / static_cast<double>(end - begin);
    Unknowns by = Unknowns::Unit(kCoulomb);
    by[kStribeck] = grid.level * stribeck_share(speed, priors.stribeck_speed);
    const PosteriorMoments force = grid.posterior.of(by, speed);
    const double force_std = std::sqrt(force.variance);
    // The force is left out as the coefficient is: a body hardly slides, or the force is mostly
    // inertia.
    if (force_std * kIdentifiedFactor >= force.mean) continue;
    result.sliding_force.push_back({speed, force.mean, force_std});
  }
}

void set_coefficient(const FrictionPriors& priors, FrictionPosterior& result) {
  const IdentifiedParameter& mass = result.mass;
  if (!mass.is_excited && !priors.mass) return;
  const double used_mass = priors.mass.value_or(mass.value);
  const double weight = used_mass * priors.gravity;
  const double value = result.coulomb.value / weight;
  const Eigen::Vector2d by(-value / used_mass, 1.0 / weight);
  const double variance = by.dot(result.covariance.topLeftCorner<2, 2>() * by);
  result.coefficient = {value, std::sqrt(std::max(variance, 0.0)), result.coulomb.is_excited};
}

}  // namespace

double place_correlation(double travel, double correlation_path) {
  return std::exp(-2.0 * travel / correlation_path);
}

FrictionPosterior infer_friction(std::span<const FrictionSample> samples,
                                 const FrictionPriors& priors) {
  PCAVR_REQUIRE(priors.max_viscous > 0.0 && priors.scatter > 0.0 && priors.scatter_factor > 1.0);
  FrictionPosterior result;
  if (samples.empty() || !std::all_of(samples.begin(), samples.end(), is_finite)) return result;
  const FrictionGrid grid = detail::solve_friction_grid(samples, priors);
  const Posterior& posterior = grid.posterior;
  if (posterior.grid.empty()) return result;
  result.is_valid = true;
  result.samples = samples.size();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    result.pushes += i == 0 || samples[i].push != samples[i - 1].push;
  }
  result.mass = marginal_of(posterior.of(Unknowns::Unit(kMass), 0.0));
  result.coulomb = marginal_of(posterior.of(Unknowns::Unit(kCoulomb), 0.0));
  result.viscous = marginal_of(posterior.of(Unknowns::Zero(), 1.0));
  for (std::size_t i = 0; i < posterior.grid.size(); ++i) {
    result.scatter += posterior.weights[i] * posterior.grid[i].between;
    result.place_scatter += posterior.weights[i] * posterior.grid[i].within;
  }
  set_covariance(posterior, result);
  if (!priors.mass) widen_mass(samples, result);
  const double uniform_std = priors.max_viscous / std::sqrt(12.0);
  result.viscous.is_excited = result.viscous.std * kIdentifiedFactor < uniform_std;
  // In slow pushes, friction that varies with the place changes with the speed as inertia would.
  // The coefficient that follows, whatever the force's unit is, shows whether it is a true mass.
  result.mass.is_excited =
      !priors.mass && result.mass.std < kMaxPosteriorMassStd * result.mass.value &&
      result.coulomb.value > priors.min_coefficient * result.mass.value * priors.gravity;
  result.coulomb.is_excited = result.coulomb.std * kIdentifiedFactor < result.coulomb.value;
  set_coefficient(priors, result);
  set_forces(samples, grid, priors, result);
  return result;
}

}  // namespace pcavr
