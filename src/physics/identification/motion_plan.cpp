// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

#include "physics/identification/derivative_noise.hpp"

namespace pcavr {
namespace {

constexpr double kMeanShare = 0.6;        // of the tip's maximum speed: mean speed of a slide
constexpr double kModulationShare = 0.6;  // of the mean speed: it never stops
constexpr double kSettlePeriods = 0.5;    // of the modulation, at either end: it grows, it fades
constexpr std::uint64_t kPlanSeed = 1;    // of the noise: a plan is the same each time
constexpr double kPressDwell = 0.1;       // [s] of a press at its depth
constexpr double kPressMargin = 0.2;      // [s] free before and after it
constexpr int kMaxSeries = 4;

/// Values of a standard normal for n contacts, with mean 0 and variance 1: a sample as it is
/// expected, not as it happens to be drawn.
std::vector<double> expected_normals(int count, Random& random) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  double mean = 0.0, squares = 0.0;
  for (int i = 0; i < count; ++i) values.push_back(random.normal());
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += std::pow(value - mean, 2) / count;
  if (count == 1) return {1.0};
  for (double& value : values) value = (value - mean) / std::sqrt(squares);
  return values;
}

/// Noise of std 1 of samples half a smoothing window apart: a first order moving average.
class OverlappingNoise {
 public:
  /// `correlation` is with the sample before, in (-0.5, 0.5): the shares of two shocks of std 1 are
  /// the cosine and the sine of an angle, and their product is the correlation.
  OverlappingNoise(double correlation, Random& random)
      : angle_(0.5 * std::asin(2.0 * correlation)), last_(random.normal()) {}

  [[nodiscard]] double next(Random& random) {
    const double before = last_;
    last_ = random.normal();
    return std::cos(angle_) * last_ + std::sin(angle_) * before;
  }

 private:
  double angle_;
  double last_;
};

/// The samples of planned slides, by the values known so far.
class SimulatedSlides {
 public:
  SimulatedSlides(const FrictionPosterior& known, const SlideNoise& noise,
                  const FrictionPriors& priors, const PlanOptions& options)
      : known_(known), noise_(noise), priors_(priors), motion_(planned_slide(options)) {
    mass_ = std::max(priors.mass.value_or(known.mass.value), 0.0);
  }

  [[nodiscard]] std::vector<FrictionSample> samples(int slides) const {
    Random random(kPlanSeed);
    const std::vector<double> of_slides = expected_normals(slides, random);
    std::vector<FrictionSample> samples;
    for (std::size_t i = 0; i < of_slides.size(); ++i) {
      append_one(i, known_.scatter * of_slides[i], random, samples);
    }
    return samples;
  }

 private:
  /// `off`: this push's friction, less that of all, as a share. Along the path it varies as the
  /// inference assumes.
  void append_one(std::size_t push, double off, Random& random,
                  std::vector<FrictionSample>& samples) const {
    const double omega = 2.0 * std::numbers::pi * motion_.frequency;
    const double duration =
        motion_.distance / motion_.speed - 2.0 * kSettlePeriods / motion_.frequency;
    double of_place = known_.place_scatter * random.normal();
    OverlappingNoise force_noise(kForceCorrelation, random);
    OverlappingNoise speed_noise(kSpeedCorrelation, random);
    OverlappingNoise acceleration_noise(kAccelerationCorrelation, random);
    for (double t = 0.0; t < duration; t += noise_.interval) {
      FrictionSample sample{.t = t, .push = push};
      sample.speed = motion_.speed + motion_.amplitude * omega * std::cos(omega * t);
      sample.acceleration = -motion_.amplitude * omega * omega * std::sin(omega * t);
      sample.travel = sample.speed * noise_.interval;
      const double kept = place_correlation(sample.travel, priors_.correlation_path);
      of_place =
          kept * of_place + std::sqrt(1.0 - kept * kept) * known_.place_scatter * random.normal();
      sample.force = mass_ * sample.acceleration + known_.viscous.value * sample.speed +
                     known_.coulomb.value * (1.0 + off + of_place) +
                     noise_.force_std * force_noise.next(random);
      sample.speed += noise_.speed_std * speed_noise.next(random);
      sample.acceleration += noise_.acceleration_std * acceleration_noise.next(random);
      sample.is_adjacent = t > 0.0;
      sample.force_std = noise_.force_std;
      sample.speed_std = noise_.speed_std;
      sample.acceleration_std = noise_.acceleration_std;
      samples.push_back(sample);
    }
  }

  const FrictionPosterior& known_;
  const SlideNoise& noise_;
  const FrictionPriors& priors_;
  SlideMotion motion_;
  double mass_ = 0.0;
};

bool has_share(const IdentifiedParameter& parameter, double share) {
  return parameter.std <= share * std::abs(parameter.value);
}

bool reaches(const FrictionPosterior& posterior, bool is_mass_given, const PlanOptions& options) {
  if (!is_mass_given && !has_share(posterior.mass, options.mass_std)) return false;
  return has_share(posterior.viscous, options.viscous_std) && posterior.coefficient.is_excited &&
         has_share(posterior.coefficient, options.coefficient_std);
}

/// Depth of the tip where the command is at the depth `command` [m]: arm and contact in series.
double tip_depth(const HuntCrossley& law, double command, double arm_stiffness) {
  double low = 0.0, high = command;
  constexpr int kBisections = 50;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    const bool is_too_deep = elastic_force(law, middle) > arm_stiffness * (command - middle);
    (is_too_deep ? high : low) = middle;
  }
  return low;
}

/// Force and tip of one press: down at a constant speed, a dwell, and up again.
struct SimulatedPress {
  std::vector<double> t, tool, force;

  SimulatedPress(const HuntCrossley& law, const PressNoise& noise, double command_speed,
                 double command, double arm_stiffness, Random& random) {
    const double depth = tip_depth(law, command, arm_stiffness);
    const double speed = command_speed * depth / command;
    const double turn = kPressMargin + depth / speed;
    const double end = turn + kPressDwell + depth / speed + kPressMargin;
    for (double now = 0.0; now < end; now += noise.interval) {
      double x = std::min(speed * (now - kPressMargin), depth);
      double rate = now < turn ? speed : 0.0;
      if (now > turn + kPressDwell) {
        x = depth - speed * (now - turn - kPressDwell);
        rate = -speed;
      }
      t.push_back(now);
      tool.push_back(x + noise.tip_std * random.normal());
      force.push_back(contact_force(law, x, rate).force + noise.force_std * random.normal());
    }
  }
};

bool reaches(const ContactFit& fit, bool is_damping_known, const PlanOptions& options) {
  if (!fit.is_valid || fit.exponent.std > options.exponent_std) return false;
  return !is_damping_known ||
         (fit.damping.is_excited && has_share(fit.damping, options.damping_std));
}

}  // namespace

SlideMotion planned_slide(const PlanOptions& options) {
  const double speed = kMeanShare * options.max_speed;
  const double amplitude = kModulationShare * speed / (2.0 * std::numbers::pi * options.frequency);
  return {speed, amplitude, options.frequency, options.slide_distance};
}

SlidePlan plan_slides(const FrictionPosterior& known, const SlideNoise& noise,
                      const FrictionPriors& priors, const PlanOptions& options) {
  PCAVR_REQUIRE(known.is_valid && noise.interval > 0.0);
  const SimulatedSlides slides(known, noise, priors, options);
  SlidePlan plan;
  while (!plan.is_enough && plan.slides < options.max_contacts) {
    ++plan.slides;
    plan.expected = infer_friction(slides.samples(plan.slides), priors);
    plan.is_enough = reaches(plan.expected, priors.mass.has_value(), options);
  }
  return plan;
}

LimitPlan plan_limits(const LimitOfPushes& known, double push_std, double common_std,
                      const FrictionPriors& priors, const PlanOptions& options) {
  PCAVR_REQUIRE(known.limit.value > 0.0 && push_std >= 0.0);
  const double spread = std::hypot(known.scatter, push_std);
  LimitPlan plan;
  while (!plan.is_enough && plan.pushes < options.max_contacts) {
    ++plan.pushes;
    Random random(kPlanSeed);
    std::vector<IdentifiedParameter> planned;
    for (const double normal : expected_normals(plan.pushes, random)) {
      planned.push_back({known.limit.value + spread * normal, push_std, true});
    }
    const LimitOfPushes expected = combine_limits(planned, priors.scatter, priors.scatter_factor);
    plan.expected_std = std::hypot(expected.limit.std, common_std);
    plan.is_enough = plan.expected_std <= options.limit_std * known.limit.value;
  }
  return plan;
}

PressPlan plan_presses(const HuntCrossley& known, const PressNoise& noise,
                       const ContactFitOptions& fit, const PlanOptions& options) {
  PCAVR_REQUIRE(known.stiffness > 0.0 && noise.interval > 0.0);
  PressPlan plan;
  plan.depth = std::min(options.press_depth, static_penetration(known, options.max_force));
  Random random(kPlanSeed);
  std::vector<SimulatedPress> presses;
  while (!plan.is_enough && plan.series < std::min(kMaxSeries, options.max_contacts)) {
    ++plan.series;
    for (const double speed : kPressSpeeds) {
      presses.emplace_back(known, noise, speed, plan.depth, options.arm_stiffness, random);
    }
    std::vector<ForceMotion> series;
    series.reserve(presses.size());
    for (const SimulatedPress& press : presses) {
      series.push_back({press.t, press.tool, press.force, noise.tip_std});
    }
    plan.expected = identify_contact(series, fit).best();
    plan.is_enough = reaches(plan.expected, known.damping > 0.0, options);
  }
  return plan;
}

}  // namespace pcavr
