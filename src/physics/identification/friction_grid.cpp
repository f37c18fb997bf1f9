// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/friction_grid.hpp"

#include <array>
#include <limits>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/friction/stribeck.hpp"

#include "physics/identification/derivative_noise.hpp"
#include "physics/identification/expected_speeds.hpp"
#include "physics/identification/push_effects.hpp"

namespace pcavr::detail {
namespace {

constexpr int kViscousSteps = 40;         // of the prior's range, then again of the posterior's
constexpr double kRefinedRange = 5.0;     // in stds of the posterior, on either side
constexpr int kGuessedViscousSteps = 10;  // while samples are weighed
constexpr int kScatterSteps = 9;
constexpr int kCoarseStride =
    2;  // of the scatters, where only the range of viscous friction counts
constexpr double kMaxScatterStds = 3.2;  // of the prior's logarithm: tenths of a per cent to 20 %
constexpr int kDriftSteps = 3;           // of the share of the scatter that is a drift
constexpr double kNegligibleLogWeight = -30.0;  // of the highest: all together, 1e-9 of the weight
constexpr double kImpossible = -std::numeric_limits<double>::infinity();
constexpr double kMaxResidual = 2.5;  // in stds; beyond it a sample's std grows with its residual
constexpr int kFrictionReweightings = 3;
constexpr double kTurningInertia = 0.5;    // error of the inertial force of a turning object, share
constexpr double kFlatPriorShare = 100.0;  // std of a flat prior, in units of the typical value
constexpr double kMaxMassFactor = 10.0;    // of the typical mass, for the effective variance
constexpr double kGuessedFriction = 0.3;   // coefficient, for a first guess of the mass

using PushSums = PushSums<kColumns>;
using NormalEquations = NormalEquations<kColumns>;
using PlaceFilter = PlaceFilter<kColumns>;

/// Range of viscous friction [N s/m] that a grid covers.
struct ViscousRange {
  double low = 0.0, high = 0.0;
};

class Inference {
 public:
  Inference(std::span<const FrictionSample> samples, const FrictionPriors& priors)
      : samples_(with_expected_speeds(samples)), priors_(priors), inflation_(samples.size(), 1.0) {
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

  [[nodiscard]] FrictionGrid solve() {
    ViscousRange range{0.0, priors_.max_viscous};
    for (int i = 0; i < kFrictionReweightings; ++i) {
      const WeightedGrid guessed = weigh_grid(range, kGuessedViscousSteps);
      reweight(solve_at(guessed, guessed.best()));
    }
    const PosteriorMoments viscous =
        viscous_of(weigh_grid(range, kViscousSteps, kCoarseStride).points);
    const double step = priors_.max_viscous / kViscousSteps;
    const double reach = kRefinedRange * std::max(std::sqrt(viscous.variance), 0.3 * step);
    range.low = std::max(range.low, viscous.mean - reach);
    range.high = std::min(range.high, viscous.mean + reach);
    return {Posterior(solved(weigh_grid(range, kViscousSteps))), level_, pushes_};
  }

 private:
  [[nodiscard]] Unknowns row_of(const FrictionSample& sample, double viscous) const {
    Unknowns row;
    row << 1.0, sample.is_turning ? 0.0 : sample.acceleration,
        level_ * stribeck_share(sample.speed, priors_.stribeck_speed),
        level_ * sample.rotation_share,
        mass_guess_ * sample.acceleration_change + viscous * sample.speed_change,
        mass_guess_ * sample.damping_acceleration_change + viscous * sample.damping_speed_change;
    return row;
  }

  /// The force that is left for Coulomb friction and the other linear terms. While the object
  /// turns, its inertia is known roughly only, and is not used to identify the mass.
  [[nodiscard]] double value_of(const FrictionSample& sample, double viscous) const {
    const double inertial = sample.is_turning ? mass_guess_ * sample.acceleration : 0.0;
    return sample.force - inertial - viscous * sample.speed;
  }
  [[nodiscard]] double turning_variance(const FrictionSample& sample) const {
    return sample.is_turning ? std::pow(kTurningInertia * mass_guess_ * sample.acceleration, 2)
                             : 0.0;
  }

  /// Noise of the measured force less the model's, and its covariance with the sample before, whose
  /// smoothing window overlaps. The noise that two different signals share there cancels out,
  /// except the force's noise in the acceleration.
  [[nodiscard]] NoiseCovariance noise_of(std::size_t i, double viscous) const {
    const FrictionSample& sample = samples_[i];
    const double force = std::pow(sample.force_std, 2);
    const double speed = std::pow(viscous * sample.speed_std, 2);
    const double inertia = std::pow(mass_guess_ * sample.acceleration_std, 2);
    const double common = sample.is_turning ? 0.0 : 2.0 * mass_guess_ * sample.noise_covariance;
    const double all = force + speed + inertia - common + turning_variance(sample);
    NoiseCovariance noise{inflation_[i] * all, 0.0};
    if (!sample.is_adjacent) return noise;
    noise.next = std::sqrt(inflation_[i] * inflation_[i - 1]) *
                 (kForceCorrelation * force + kSpeedCorrelation * speed +
                  kAccelerationCorrelation * inertia - kForceAccelerationCorrelation * common);
    return noise;
  }
  /// Variance of the noise and of friction's variation with the place.
  [[nodiscard]] double variance_of(std::size_t i, double viscous, double within) const {
    return noise_of(i, viscous).own + std::pow(within * level_, 2);
  }

  /// Covariances of the acceleration's noise with itself, and with the force's.
  [[nodiscard]] static std::array<NoiseCovariance, 2> acceleration_noise_of(
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
  /// The points of a grid, with the sums of as many successive ones each.
  struct WeightedGrid {
    std::vector<Totals> totals;
    std::vector<GridPoint> points;

    [[nodiscard]] std::size_t best() const {
      const auto highest = std::max_element(points.begin(), points.end(), is_less_likely);
      return static_cast<std::size_t>(highest - points.begin());
    }
    [[nodiscard]] const Totals& totals_of(std::size_t point) const {
      return totals[point / (points.size() / totals.size())];
    }
  };
  static bool is_less_likely(const GridPoint& a, const GridPoint& b) {
    return a.log_weight < b.log_weight;
  }

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
    marginalise_pushes(totals.pushes, scatter_of(point.between, point.drift), equations);
    return equations;
  }

  [[nodiscard]] double log_weight_of(const NormalEquations& equations,
                                     const GridPoint& point) const {
    const Eigen::LLT<Information> measured(equations.information);
    const double log_information = 2.0 * measured.matrixLLT().diagonal().array().log().sum();
    const double prior_misfit =
        std::pow(scatter_in_stds(point.between), 2) + std::pow(scatter_in_stds(point.within), 2);
    // Half of the solutions, by the Cholesky factor alone, is enough for the mean and the variance
    // of the Coulomb force, and for the squares that are explained.
    const Unknowns weighted = measured.matrixL().solve(equations.weighted);
    const Unknowns coulomb = measured.matrixL().solve(Unknowns(Unknowns::Unit(kCoulomb)));
    const double explained = weighted.squaredNorm();
    return log_share_above_zero(coulomb.dot(weighted) / coulomb.norm()) -
           0.5 * (equations.misfit - explained + equations.log_determinant + log_information +
                  prior_misfit);
  }

  [[nodiscard]] Conditional solve_at(const WeightedGrid& grid, std::size_t at) const {
    Conditional point{grid.points[at], {}, {}};
    const Totals& totals = grid.totals_of(at);
    NormalEquations equations = equations_of(totals, point);
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
  [[nodiscard]] PushScatter scatter_of(double between, double drift) const {
    const double all = between * level_;
    if (drift <= 0.0) return {priors_.bias_std, all, 0.0};
    const double own = all * std::sqrt(1.0 - drift);
    return {std::hypot(priors_.bias_std, own), all * std::sqrt(drift), priors_.push_correlation};
  }

  /// Weighs the grid on each `stride`th of the scatters.
  [[nodiscard]] WeightedGrid weigh_grid(const ViscousRange& range, int viscous_steps,
                                        int stride = 1) const {
    WeightedGrid grid;
    for (int w = 0; w < kScatterSteps; w += stride) {
      for (int b = 0; b < viscous_steps; ++b) {
        const double viscous = range.low + (range.high - range.low) * (b + 0.5) / viscous_steps;
        grid.totals.push_back(totals_at(viscous, scatter_at(w)));
        for (int s = 0; s < kScatterSteps * drift_steps(); ++s) {
          if (s / drift_steps() % stride != 0) continue;
          GridPoint point{viscous, scatter_at(s / drift_steps()), scatter_at(w)};
          point.log_weight = kImpossible;
          point.drift = drift_steps() > 1
                            ? static_cast<double>(s % drift_steps()) / (drift_steps() - 1)
                            : 0.0;
          const double weight = log_weight_of(equations_of(grid.totals.back(), point), point);
          // A point without a solution keeps no weight.
          if (!std::isnan(weight)) point.log_weight = weight;
          grid.points.push_back(point);
        }
      }
    }
    return grid;
  }

  /// A single push shows no drift.
  [[nodiscard]] int drift_steps() const { return pushes_ > 1 ? kDriftSteps : 1; }

  /// The solutions without the points of next to no weight, which are most of them.
  [[nodiscard]] std::vector<Conditional> solved(const WeightedGrid& grid) const {
    const double least = grid.points[grid.best()].log_weight + kNegligibleLogWeight;
    std::vector<Conditional> kept;
    if (!std::isfinite(least)) return kept;
    for (std::size_t i = 0; i < grid.points.size(); ++i) {
      if (grid.points[i].log_weight >= least) kept.push_back(solve_at(grid, i));
    }
    return kept;
  }

  /// Moments of viscous friction [N s/m] alone, which need no solution.
  [[nodiscard]] static PosteriorMoments viscous_of(const std::vector<GridPoint>& points) {
    const double highest =
        std::max_element(points.begin(), points.end(), is_less_likely)->log_weight;
    double sum = 0.0, first = 0.0, second = 0.0;
    for (const GridPoint& point : points) {
      const double weight = std::exp(point.log_weight - highest);
      sum += weight, first += weight * point.viscous,
          second += weight * point.viscous * point.viscous;
    }
    const double mean = first / sum;
    return {mean, std::max(second / sum - mean * mean, 0.0)};
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

}  // namespace

FrictionGrid solve_friction_grid(std::span<const FrictionSample> samples,
                                 const FrictionPriors& priors) {
  return Inference(samples, priors).solve();
}

}  // namespace pcavr::detail
