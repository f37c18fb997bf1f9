// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/estimator.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kFilterHalfWidth = 0.014;  // [s] of the filter, as in the estimators' tests
constexpr double kMinForce = 0.02;  // of the largest: below, the relative error is not meaningful
constexpr double kSettled = 0.10;   // of the force: paper C's threshold
constexpr double kLag = 1.4;        // in correlated samples: the filter's whole width
constexpr double kMinNoise = 1e-6;  // of the largest force: a synthetic one may have none
constexpr double kStationaryHalfWidth = 0.050;  // [s] over which a stationary tip is at rest
constexpr double kMaxStationaryMotion = 0.01;   // of the penetration
constexpr int kPlotStride = 5;                  // one of so many samples is kept for the plots

struct FilteredSample {
  double t = 0.0;  ///< [s] in contact
  std::array<double, 3> regressors{};
  double force = 0.0;
  std::size_t press = 0;
  bool is_stationary = false;  ///< the tip is at rest in the object
};

/// Whether the tip moves by less than one sample's noise, or a small share of its penetration.
bool is_stationary(const ForceMotion& press, double t, double penetration, double tip_noise) {
  const SmoothedSample slow = smooth_at(press.t, press.tool, t, kStationaryHalfWidth);
  return slow.is_valid && 2.0 * kStationaryHalfWidth * std::abs(slow.rate) <
                              std::max(tip_noise, kMaxStationaryMotion * penetration);
}

/// The filtered samples in contact, press after press, on a common axis of contact time.
std::vector<FilteredSample> filtered(std::span<const ForceMotion> presses,
                                     const ContactIdentification& found, double& half_width) {
  const ContactFit& fit = found.best();
  std::vector<FilteredSample> samples;
  double largest = 0.0;
  for (const ForceMotion& press : presses) {
    for (const double force : press.force) largest = std::max(largest, force);
  }
  double clock = 0.0;
  for (std::size_t k = 0; k < found.touched.size(); ++k) {
    const ForceMotion& press = presses[found.touched[k]];
    const double interval = mean_interval(press.t);
    const double noise = std::max(estimate_noise_std(press.force), kMinNoise * largest);
    half_width = std::max(kFilterHalfWidth, 3.0 * interval);
    CausalFilter filter(half_width, 1.0 / interval, noise);
    const double tip_noise = estimate_noise_std(press.tool);
    for (std::size_t i = 0; i < press.t.size(); ++i) {
      const auto out = filter.step(press.t[i], press.tool[i], press.force[i]);
      const double penetration = out ? out->position - fit.surface[k] : 0.0;
      if (penetration <= 0.0 || out->force < kMinForce * largest) continue;
      FilteredSample& sample = samples.emplace_back();
      const double power = penetration_power(penetration, fit.exponent.value);
      const bool is_curved = fit.regressor == ContactRegressor::hunt_crossley;
      sample.t = clock;
      sample.regressors = {out->acceleration, is_curved ? power * out->speed : out->speed, power};
      sample.force = out->force;
      sample.press = k;
      sample.is_stationary = is_stationary(press, out->t, penetration, tip_noise);
      clock += interval;
    }
  }
  return samples;
}

EstimatorOptions<3> options_of(EstimationMethod method, const std::vector<FilteredSample>& samples,
                               double correlated, const EstimatorOptions<3>& configured) {
  EstimatorOptions<3> options = configured;
  options.method = method;
  for (std::size_t k = 0; k < 3; ++k) {
    double squares = 0.0;
    for (const FilteredSample& sample : samples) squares += std::pow(sample.regressors[k], 2);
    options.scale[k] = std::sqrt(squares / static_cast<double>(samples.size())) + 1e-12;
  }
  options.correlated_samples = correlated;
  return options;
}

/// Errors of the estimated force once an estimator has settled.
class SteadyErrors {
 public:
  void add(const FilteredSample& sample, double estimated) {
    squares_ += std::pow(sample.force - estimated, 2);
    force_squares_ += sample.force * sample.force;
    if (!sample.is_stationary) return;
    if (presses_.empty() || presses_.back().press != sample.press) {
      presses_.push_back({sample.press});
    }
    presses_.back().measured += sample.force;
    presses_.back().estimated += estimated;
  }

  [[nodiscard]] double rms() const { return std::sqrt(squares_ / force_squares_); }
  /// Relative error of each press's mean force, averaged over the presses; nothing where the tip
  /// was stationary in none.
  [[nodiscard]] std::optional<double> mean_force_error() const {
    if (presses_.empty()) return std::nullopt;
    double sum = 0.0;
    for (const PressForces& press : presses_) {
      sum += std::abs(press.estimated / press.measured - 1.0);
    }
    return sum / static_cast<double>(presses_.size());
  }

 private:
  struct PressForces {
    std::size_t press = 0;
    double measured = 0.0, estimated = 0.0;  ///< [N] sums
  };
  double squares_ = 0.0;
  double force_squares_ = 0.0;
  std::vector<PressForces> presses_;
};

/// One of the three methods, with its earlier parameters.
class ComparedEstimator {
 public:
  explicit ComparedEstimator(const EstimatorOptions<3>& options)
      : earlier_(std::max<std::size_t>(
            1, static_cast<std::size_t>(std::lround(kLag * options.correlated_samples)))),
        estimator_(options) {}

  /// Prediction by the parameters before this sample; `earlier`: by those of one filter width ago.
  struct Step {
    double prediction = 0.0, earlier = 0.0;  ///< [N]
  };
  Step step(const FilteredSample& sample) {
    const EstimatorStep now = estimator_.step(sample.regressors, sample.force);
    std::array<double, 3>& earlier = earlier_[next_];
    next_ = (next_ + 1) % earlier_.size();
    const Step result{now.prediction, predict(sample, earlier)};
    earlier = parameters();
    return result;
  }

  [[nodiscard]] std::array<double, 3> parameters() const { return estimator_.parameters(); }
  [[nodiscard]] ParameterEstimate<3> estimate() const { return estimator_.estimate(); }

  static double predict(const FilteredSample& sample, const std::array<double, 3>& parameters) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) sum += sample.regressors[k] * parameters[k];
    return sum;
  }

 private:
  std::vector<std::array<double, 3>> earlier_;
  ParameterEstimator<3> estimator_;
  std::size_t next_ = 0;
};

/// The sample with the largest force of the first press.
const FilteredSample& first_peak_of(const std::vector<FilteredSample>& samples) {
  const auto end = std::find_if(samples.begin(), samples.end(), [&](const FilteredSample& sample) {
    return sample.press != samples.front().press;
  });
  return *std::max_element(samples.begin(), end,
                           [](const auto& a, const auto& b) { return a.force < b.force; });
}

/// Settling: since when the parameters predict the first press's peak, before it comes.
class Settling {
 public:
  Settling(const FilteredSample& peak, double delay) : peak_(peak), delay_(delay) {}

  void add(const FilteredSample& sample, const std::array<double, 3>& parameters) {
    if (sample.press != peak_.press) return;
    const double error = ComparedEstimator::predict(peak_, parameters) - peak_.force;
    last_ = sample.t;
    if (std::abs(error) > kSettled * peak_.force) unsettled_ = sample.t;
  }
  /// [s] from the touch; nothing where it never settles.
  [[nodiscard]] std::optional<double> time() const {
    if (unsettled_ >= last_) return std::nullopt;
    return unsettled_ + delay_;
  }

 private:
  const FilteredSample& peak_;
  double delay_ = 0.0;
  double unsettled_ = 0.0, last_ = 0.0;
};

/// Runs one method over all samples.
EstimatorTrace trace_of(EstimationMethod method, const std::vector<FilteredSample>& samples,
                        double correlated, double delay, const EstimatorOptions<3>& configured) {
  ComparedEstimator estimator(options_of(method, samples, correlated, configured));
  EstimatorTrace trace;
  trace.method = method;
  SteadyErrors steady;
  Settling settling(first_peak_of(samples), delay);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ComparedEstimator::Step step = estimator.step(samples[i]);
    settling.add(samples[i], estimator.parameters());
    if (i >= samples.size() / 2) steady.add(samples[i], step.earlier);
    if (i % kPlotStride != 0) continue;
    const ParameterEstimate<3> now = estimator.estimate();
    trace.t.push_back(samples[i].t);
    trace.measured.push_back(samples[i].force);
    trace.estimated.push_back(step.prediction);
    for (std::size_t k = 0; k < 3; ++k) {
      trace.value[k].push_back(now.value[k]);
      trace.std[k].push_back(now.std[k]);
    }
  }
  trace.steady_error = steady.rms();
  trace.mean_force_error = steady.mean_force_error();
  trace.settling = settling.time();
  return trace;
}

}  // namespace

std::vector<EstimatorTrace> compare_estimators(std::span<const ForceMotion> presses,
                                               const ContactIdentification& found,
                                               const EstimatorOptions<3>& options) {
  std::vector<EstimatorTrace> traces;
  double half_width = kFilterHalfWidth;
  const std::vector<FilteredSample> samples = filtered(presses, found, half_width);
  if (samples.size() < 100) return traces;
  const double interval = samples[1].t - samples[0].t;
  const double correlated = correlated_samples(half_width, interval);
  for (const EstimationMethod method :
       {EstimationMethod::block, EstimationMethod::exponential, EstimationMethod::averaged}) {
    traces.push_back(trace_of(method, samples, correlated, half_width + 2.0 * interval, options));
  }
  return traces;
}

}  // namespace pcavr
