// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/friction_posterior.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "pcavr/core/check.hpp"
#include "pcavr/core/median.hpp"

#include "identification/derivative_noise.hpp"
#include "identification/expected_speeds.hpp"
#include "identification/push_effects.hpp"

namespace pcavr {
namespace {

constexpr int kViscousSteps = 40;         // of the prior's range, then again of the posterior's
constexpr double kRefinedRange = 5.0;     // in stds of the posterior, on either side
constexpr int kGuessedViscousSteps = 10;  // while samples are weighed
constexpr int kScatterSteps = 9;
constexpr double kMaxScatterStds = 3.2;  // of the prior's logarithm: tenths of a per cent to 20 %
constexpr int kDriftSteps = 3;           // of the share of the scatter that is a drift
constexpr double kNegligibleLogWeight = -30.0;  // of the highest: all together, 1e-9 of the weight
constexpr double kMaxResidual = 2.5;  // in stds; beyond it a sample's std grows with its residual
constexpr int kFrictionReweightings = 3;
constexpr double kMaxPosteriorMassStd = 0.1;  // as a share of the mass
constexpr double kTurningInertia = 0.5;    // error of the inertial force of a turning object, share
constexpr double kFlatPriorShare = 100.0;  // std of a flat prior, in units of the typical value
constexpr double kMaxMassFactor = 10.0;    // of the typical mass, for the effective variance
constexpr double kSameSpeed = 1.25;        // pushes whose speeds are within this factor share a row
constexpr double kMinRowSpeed = 1e-4;      // [m/s]
constexpr double kGuessedFriction = 0.3;   // coefficient, for a first guess of the mass

/// Unknowns in closed form.
enum Column { kCoulomb, kMass, kStribeck, kSize, kCompliance, kDamping, kColumns };
using Unknowns = Eigen::Matrix<double, kColumns, 1>;
using Information = Eigen::Matrix<double, kColumns, kColumns>;
using PushSums = detail::PushSums<kColumns>;
using NormalEquations = detail::NormalEquations<kColumns>;
using PlaceFilter = detail::PlaceFilter<kColumns>;

/// Of the unknowns on a grid, with the log evidence there.
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

/// The posterior on the whole grid.
struct Posterior {
  std::vector<Conditional> grid;
  std::vector<double> weights;

  explicit Posterior(std::vector<Conditional> points) : grid(std::move(points)) {
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

  /// Of `by` . unknowns + by_viscous B.
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

/// [N s/m] of viscous friction that a grid covers.
struct ViscousRange {
  double low = 0.0, high = 0.0;
};

class Inference {
 public:
  Inference(std::span<const FrictionSample> samples, const FrictionPriors& priors)
      : samples_(detail::with_expected_speeds(samples)),
        priors_(priors),
        inflation_(samples.size(), 1.0) {
    std::vector<double> forces;
    for (const FrictionSample& sample : samples) {
      PCAVR_REQUIRE(sample.push + 1 >= pushes_, sample.push, pushes_);
      forces.push_back(sample.force);
      pushes_ = std::max(pushes_, sample.push + 1);
    }
    level_ = std::max(median(forces), 1e-6);
    mass_scale_ = priors.mass.value_or(level_ / (kGuessedFriction * priors.gravity));
    mass_guess_ = mass_scale_;
  }

  /// After samples that do not fit have been weighed down.
  Posterior solve() {
    ViscousRange range{0.0, priors_.max_viscous};
    for (int i = 0; i < kFrictionReweightings; ++i) {
      const Posterior posterior(evaluate_grid(range, kGuessedViscousSteps));
      reweight(posterior.best());
    }
    const Posterior coarse(evaluate_grid(range, kViscousSteps));
    const PosteriorMoments viscous = coarse.of(Unknowns::Zero(), 1.0);
    const double step = priors_.max_viscous / kViscousSteps;
    const double reach = kRefinedRange * std::max(std::sqrt(viscous.variance), 0.3 * step);
    range.low = std::max(range.low, viscous.mean - reach);
    range.high = std::min(range.high, viscous.mean + reach);
    return Posterior(evaluate_grid(range, kViscousSteps));
  }

  [[nodiscard]] std::size_t pushes() const { return pushes_; }
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] const FrictionPriors& priors() const { return priors_; }

 private:
  [[nodiscard]] Unknowns row_of(const FrictionSample& sample, double viscous) const {
    Unknowns row;
    row << 1.0, sample.is_turning ? 0.0 : sample.acceleration,
        level_ * std::exp(-sample.speed / priors_.stribeck_speed), level_ * sample.rotation_share,
        mass_guess_ * sample.acceleration_change + viscous * sample.speed_change,
        mass_guess_ * sample.damping_acceleration_change + viscous * sample.damping_speed_change;
    return row;
  }

  /// What Coulomb friction and the other linear terms explain. While the object turns, its inertia
  /// is known roughly only, and is not used to identify the mass.
  [[nodiscard]] double value_of(const FrictionSample& sample, double viscous) const {
    const double inertial = sample.is_turning ? mass_guess_ * sample.acceleration : 0.0;
    return sample.force - inertial - viscous * sample.speed;
  }
  [[nodiscard]] double turning_variance(const FrictionSample& sample) const {
    return sample.is_turning ? std::pow(kTurningInertia * mass_guess_ * sample.acceleration, 2)
                             : 0.0;
  }

  /// Of the force over the model's, also with the sample before, whose smoothing window overlaps:
  /// what two different signals share there cancels out, but the force's noise in the acceleration.
  [[nodiscard]] detail::NoiseCovariance noise_of(std::size_t i, double viscous) const {
    const FrictionSample& sample = samples_[i];
    const double force = std::pow(sample.force_std, 2);
    const double speed = std::pow(viscous * sample.speed_std, 2);
    const double inertia = std::pow(mass_guess_ * sample.acceleration_std, 2);
    const double common = sample.is_turning ? 0.0 : 2.0 * mass_guess_ * sample.noise_covariance;
    const double all = force + speed + inertia - common + turning_variance(sample);
    detail::NoiseCovariance noise{inflation_[i] * all, 0.0};
    if (!sample.is_adjacent) return noise;
    noise.next = std::sqrt(inflation_[i] * inflation_[i - 1]) *
                 (kForceCorrelation * force + kSpeedCorrelation * speed +
                  kAccelerationCorrelation * inertia - kForceAccelerationCorrelation * common);
    return noise;
  }
  /// And of friction's variation with the place.
  [[nodiscard]] double variance_of(std::size_t i, double viscous, double within) const {
    return noise_of(i, viscous).own + std::pow(within * level_, 2);
  }

  /// Of the acceleration with itself, and with the force.
  [[nodiscard]] static std::array<detail::NoiseCovariance, 2> acceleration_noise_of(
      const FrictionSample& sample) {
    if (sample.is_turning) return {};
    const double squares = sample.acceleration_std * sample.acceleration_std;
    const double shared = sample.is_adjacent ? 1.0 : 0.0;
    return {{{squares, shared * kAccelerationCorrelation * squares},
             {sample.noise_covariance,
              shared * kForceAccelerationCorrelation * sample.noise_covariance}}};
  }

  /// Correlation of the friction at this sample's place with that at the one's before.
  [[nodiscard]] double kept_from_last(std::size_t i) const {
    if (i == 0 || samples_[i].push != samples_[i - 1].push) return 0.0;
    return place_correlation(samples_[i].travel, priors_.correlation_path);
  }

  [[nodiscard]] Information prior_information() const {
    Unknowns information;
    const double mass_std =
        priors_.mass ? priors_.mass_share * *priors_.mass : kFlatPriorShare * mass_scale_;
    information << std::pow(kFlatPriorShare * level_, -2), std::pow(mass_std, -2),
        std::pow(priors_.stribeck_share, -2), std::pow(priors_.support_size_share, -2), 1.0, 1.0;
    return information.asDiagonal();
  }
  [[nodiscard]] Unknowns prior_mean() const {
    Unknowns mean = Unknowns::Zero();
    if (priors_.mass) mean[kMass] = *priors_.mass;
    mean[kStribeck] = priors_.stribeck_share;
    return mean;
  }

  /// All samples at one viscous friction and scatter within pushes.
  struct Totals {
    NormalEquations equations;
    std::vector<PushSums> pushes;
    double attenuation = 0.0;    ///< squares of the accelerations' noise in the information
    double noise_product = 0.0;  ///< products of that and the force's noise
  };
  [[nodiscard]] Totals totals_at(double viscous, double within) const {
    Totals totals;
    const Information prior = prior_information();
    NormalEquations& equations = totals.equations;
    equations.information = prior;
    equations.weighted = prior * prior_mean();
    equations.misfit = prior_mean().dot(equations.weighted);
    totals.pushes.resize(pushes_);
    PlaceFilter filter(within * level_);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const FrictionSample& sample = samples_[i];
      if (i > 0 && sample.push != samples_[i - 1].push) filter = PlaceFilter(within * level_);
      PlaceFilter::Columns columns;
      columns << row_of(sample, viscous), value_of(sample, viscous), 1.0;
      const auto whitened = filter.step(columns, noise_of(i, viscous), kept_from_last(i),
                                        acceleration_noise_of(sample));
      const Unknowns row = whitened.columns.head<kColumns>();
      const double value = whitened.columns[kColumns], one = whitened.columns[kColumns + 1];
      equations.information += row * row.transpose();
      equations.weighted += value * row;
      equations.misfit += value * value;
      equations.log_determinant += std::log(whitened.variance);
      totals.attenuation += whitened.noise[0];
      totals.noise_product += whitened.noise[1];
      PushSums& push = totals.pushes[sample.push];
      push.weight += one * one;
      push.row += one * row;
      push.value += one * value;
    }
    return totals;
  }

  [[nodiscard]] NormalEquations equations_of(const Totals& totals, const GridPoint& point) const {
    NormalEquations equations = totals.equations;
    detail::marginalise_pushes(totals.pushes, scatter_of(point.between, point.drift), equations);
    return equations;
  }

  [[nodiscard]] double log_weight_of(const NormalEquations& equations,
                                     const GridPoint& point) const {
    const Eigen::LLT<Information> measured(equations.information);
    const double log_information = 2.0 * measured.matrixLLT().diagonal().array().log().sum();
    const double prior_misfit =
        std::pow(scatter_in_stds(point.between), 2) + std::pow(scatter_in_stds(point.within), 2);
    const Unknowns mean = measured.solve(equations.weighted);
    const double explained = mean.dot(equations.weighted);
    const double coulomb_variance = measured.solve(Unknowns::Unit(kCoulomb))[kCoulomb];
    return log_share_above_zero(mean[kCoulomb] / std::sqrt(coulomb_variance)) -
           0.5 * (equations.misfit - explained + equations.log_determinant + log_information +
                  prior_misfit);
  }

  [[nodiscard]] Conditional solve_at(const Totals& totals, const GridPoint& at) const {
    Conditional point{at, {}, {}};
    NormalEquations equations = equations_of(totals, at);
    const Information inverse =
        Eigen::LLT<Information>(equations.information).solve(Information::Identity());
    remove_noise(totals, 1.0 / inverse(kMass, kMass), equations);
    const Eigen::LLT<Information> factor(equations.information);
    point.mean = factor.solve(equations.weighted);
    point.covariance = factor.solve(Information::Identity());
    return point;
  }

  /// Coulomb friction is not negative: of a Gaussian that is `in_stds` above zero, the part that is
  /// possible. Fast pushes of little friction would leave it below zero at most viscous frictions.
  [[nodiscard]] static double log_share_above_zero(double in_stds) {
    constexpr double kLeast = 1e-300;  // of a double: where no viscous friction is possible
    return std::log(std::max(0.5 * std::erfc(-in_stds / std::numbers::sqrt2), kLeast));
  }

  /// The noise of the accelerations adds to their squares, and where the force has a share in it,
  /// to their products with the force. At most half of what the others leave of the squares,
  /// `excess`, so that a noise that is misjudged does no harm. Not in the evidence: there it would
  /// count as force that the mass explains, the more the smaller the scatter.
  void remove_noise(const Totals& totals, double excess, NormalEquations& equations) const {
    if (!(totals.attenuation > 0.0)) return;
    const double max_removed = 0.5 * (excess - prior_information()(kMass, kMass));
    const double removed = std::min(totals.attenuation, std::max(max_removed, 0.0));
    equations.information(kMass, kMass) -= removed;
    equations.weighted[kMass] -= removed / totals.attenuation * totals.noise_product;
  }

  /// A part of each push's own, and a share `drift` of the variance that goes from push to push:
  /// one correlation for both would take a slow drift for a short one.
  [[nodiscard]] detail::PushScatter scatter_of(double between, double drift) const {
    const double all = between * level_;
    if (drift <= 0.0) return {priors_.bias_std, all, 0.0};
    const double own = all * std::sqrt(1.0 - drift);
    return {std::hypot(priors_.bias_std, own), all * std::sqrt(drift), priors_.push_correlation};
  }

  /// Without the points that have next to no weight: they are most of them.
  [[nodiscard]] std::vector<Conditional> evaluate_grid(const ViscousRange& range,
                                                       int viscous_steps) const {
    std::vector<Totals> totals;
    std::vector<GridPoint> grid;
    for (int w = 0; w < kScatterSteps; ++w) {
      for (int b = 0; b < viscous_steps; ++b) {
        const double viscous = range.low + (range.high - range.low) * (b + 0.5) / viscous_steps;
        totals.push_back(totals_at(viscous, scatter_at(w)));
        for (int s = 0; s < kScatterSteps * kDriftSteps; ++s) {
          GridPoint point{viscous, scatter_at(s / kDriftSteps), scatter_at(w)};
          point.drift = static_cast<double>(s % kDriftSteps) / (kDriftSteps - 1);
          point.log_weight = log_weight_of(equations_of(totals.back(), point), point);
          grid.push_back(point);
        }
      }
    }
    return with_weight(totals, grid);
  }

  /// Solved; `totals`: of as many successive points of the grid each.
  [[nodiscard]] std::vector<Conditional> with_weight(const std::vector<Totals>& totals,
                                                     const std::vector<GridPoint>& grid) const {
    double highest = grid.front().log_weight;
    for (const GridPoint& point : grid) highest = std::max(highest, point.log_weight);
    const std::size_t per_totals = grid.size() / totals.size();
    std::vector<Conditional> kept;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (grid[i].log_weight < highest + kNegligibleLogWeight) continue;
      kept.push_back(solve_at(totals[i / per_totals], grid[i]));
    }
    return kept;
  }

  [[nodiscard]] double scatter_at(int step) const {
    const double in_stds = kMaxScatterStds * (2.0 * step / (kScatterSteps - 1) - 1.0);
    return priors_.scatter * std::pow(priors_.scatter_factor, in_stds);
  }
  [[nodiscard]] double scatter_in_stds(double scatter) const {
    return std::log(scatter / priors_.scatter) / std::log(priors_.scatter_factor);
  }

  /// Residuals about the push's own mean level, which the random effect explains.
  void reweight(const Conditional& best) {
    mass_guess_ = std::clamp(best.mean[kMass], 0.0, kMaxMassFactor * mass_scale_);
    std::vector<double> residuals;
    std::vector<double> sums(pushes_, 0.0), weights(pushes_, 0.0);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const FrictionSample& sample = samples_[i];
      residuals.push_back(value_of(sample, best.viscous) -
                          row_of(sample, best.viscous).dot(best.mean));
      const double weight = 1.0 / variance_of(i, best.viscous, best.within);
      sums[sample.push] += weight * residuals.back();
      weights[sample.push] += weight;
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::size_t push = samples_[i].push;
      const double std = std::sqrt(variance_of(i, best.viscous, best.within) / inflation_[i]);
      const double distance = std::abs(residuals[i] - sums[push] / weights[push]) / std;
      inflation_[i] = std::max(1.0, distance / kMaxResidual);
    }
  }

  std::vector<FrictionSample> samples_;
  FrictionPriors priors_;
  std::vector<double> inflation_;  ///< of each sample's variance
  double level_ = 0.0;             ///< [N] typical friction
  double mass_scale_ = 0.0;        ///< [kg] typical mass
  double mass_guess_ = 0.0;        ///< [kg] for the effective variance
  std::size_t pushes_ = 0;
};

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

/// One row for each speed at which pushes slid, where the force there is identified.
void set_forces(std::span<const FrictionSample> samples, const Posterior& posterior,
                const Inference& inference, FrictionPosterior& result) {
  const FrictionPriors& priors = inference.priors();
  const double level = inference.level();
  std::vector<double> speeds;
  for (std::size_t push = 0; push < inference.pushes(); ++push) {
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
    by[kStribeck] = level * std::exp(-speed / priors.stribeck_speed);
    const PosteriorMoments force = posterior.of(by, speed);
    const double force_std = std::sqrt(force.variance);
    // As of the coefficient: a body that hardly slides, or a force that is mostly inertia.
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
  if (samples.empty()) return result;
  Inference inference(samples, priors);
  const Posterior posterior = inference.solve();
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
  const double uniform_std = priors.max_viscous / std::sqrt(12.0);
  result.viscous.is_excited = result.viscous.std * kIdentifiedFactor < uniform_std;
  // In slow pushes friction that varies with the place goes with the speed as inertia would. The
  // coefficient that follows, of whatever unit the force is, shows whether it is a true mass.
  result.mass.is_excited =
      !priors.mass && result.mass.std < kMaxPosteriorMassStd * result.mass.value &&
      result.coulomb.value > priors.min_coefficient * result.mass.value * priors.gravity;
  result.coulomb.is_excited = result.coulomb.std * kIdentifiedFactor < result.coulomb.value;
  set_covariance(posterior, result);
  set_coefficient(priors, result);
  set_forces(samples, posterior, inference, result);
  return result;
}

}  // namespace pcavr
