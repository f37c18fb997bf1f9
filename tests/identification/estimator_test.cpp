// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/estimator.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "identification/plant.hpp"

namespace pcavr {
namespace {

constexpr std::array<EstimationMethod, 3> kMethods = {
    EstimationMethod::block, EstimationMethod::exponential, EstimationMethod::adaptive};

EstimatorOptions<3> options_for(EstimationMethod method) {
  EstimatorOptions<3> options;
  options.method = method;
  options.scale = {1.0, 0.1, 0.01};
  return options;
}

std::array<double, 3> rich(double t) {
  return {std::sin(11.0 * t), 0.1 * std::cos(7.0 * t), 0.01 * std::sin(3.0 * t)};
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(ParameterEstimator, FindsExactParametersWithEveryMethod) {
  const std::array<double, 3> truth = {0.5, 20.0, 3000.0};
  for (const EstimationMethod method : kMethods) {
    ParameterEstimator<3> estimator(options_for(method));
    for (int i = 0; i < 2000; ++i) {
      const auto phi = rich(0.01 * i);
      EXPECT_TRUE(estimator.step(phi, dot(phi, truth)).was_used);
    }
    const ParameterEstimate<3> estimate = estimator.estimate();
    for (std::size_t k = 0; k < 3; ++k) {
      // Exact data; the rest is the prior's bias, forgotten or outweighed to 1e-6.
      EXPECT_NEAR(estimate.value[k], truth[k], 1e-5 * truth[k]) << k;
      EXPECT_TRUE(estimate.is_excited[k]) << k;
    }
  }
}

TEST(ParameterEstimator, IsPlainLeastSquaresWithoutForgetting) {
  EstimatorOptions<2> options;
  options.method = EstimationMethod::exponential;
  options.forgetting = 1.0;
  ParameterEstimator<2> estimator(options);
  Random random(3);
  Eigen::Matrix2d normal = 1e-6 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d phi(random.normal(), random.normal());
    const double y = random.normal();
    normal += phi * phi.transpose();
    rhs += phi * y;
    estimator.step({phi[0], phi[1]}, y);
  }
  const Eigen::Vector2d expected = normal.inverse() * rhs;
  EXPECT_NEAR(estimator.parameters()[0], expected[0], 1e-10);
  EXPECT_NEAR(estimator.parameters()[1], expected[1], 1e-10);
}

TEST(ParameterEstimator, ScalingChangesConditioningOnly) {
  EstimatorOptions<3> scaled = options_for(EstimationMethod::adaptive);
  scaled.prior_information = 1e-9;
  EstimatorOptions<3> plain = scaled;
  plain.scale = {1.0, 1.0, 1.0};
  ParameterEstimator<3> one(scaled), other(plain);
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const auto phi = rich(0.002 * i);
    const double y = dot(phi, {0.5, 20.0, 3000.0}) + 0.1 * random.normal();
    one.step(phi, y);
    other.step(phi, y);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    // The priors differ: 1e-9 in units of 1 or of 0.01.
    EXPECT_NEAR(one.parameters()[k], other.parameters()[k], 1e-2 * one.estimate().std[k]);
  }
}

TEST(ParameterEstimator, StdCoversTheErrorAsOftenAsExpected) {
  int inside = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    EstimatorOptions<3> options = options_for(EstimationMethod::exponential);
    options.forgetting = 1.0;
    ParameterEstimator<3> estimator(options);
    Random random(1000 + static_cast<std::uint64_t>(run));
    for (int i = 0; i < 300; ++i) {
      const auto phi = rich(0.01 * i);
      estimator.step(phi, dot(phi, {0.5, 20.0, 3000.0}) + 0.3 * random.normal());
    }
    const ParameterEstimate<3> estimate = estimator.estimate();
    inside += std::abs(estimate.value[1] - 20.0) < estimate.std[1] ? 1 : 0;
  }
  // 68.3 % of 400, plus or minus four binomial stds of 2.3 %.
  EXPECT_NEAR(inside / double(kRuns), 0.683, 0.093);
}

TEST(ParameterEstimator, HasNoCovarianceWindUpInAMinuteWithoutExcitation) {
  for (const EstimationMethod method : kMethods) {
    EstimatorOptions<3> options = options_for(method);
    options.forgetting = 0.95;
    options.min_excitation = {0.05, 0.005, 0.0};
    ParameterEstimator<3> estimator(options);
    Random random(7);
    const std::array<double, 3> truth = {0.5, 20.0, 3000.0};
    for (int i = 0; i < 1000; ++i) {
      const auto phi = rich(0.002 * i);
      estimator.step(phi, dot(phi, truth) + 0.07 * random.normal());
    }
    for (int i = 0; i < 30000; ++i) {  // a constant press: only the position is excited
      const std::array<double, 3> phi = {0.0, 0.0, 0.005};
      estimator.step(phi, dot(phi, truth) + 0.07 * random.normal());
    }
    const ParameterEstimate<3> pressed = estimator.estimate();
    EXPECT_TRUE(pressed.is_excited[2]);
    EXPECT_NEAR(pressed.value[2], 3000.0,
                0.03 * 3000.0);                  // 0.07 N in 15 N over 20 samples, 8 sigma
    if (method != EstimationMethod::adaptive) {  // which remembers the first 2 s
      EXPECT_FALSE(pressed.is_excited[0]);
      EXPECT_FALSE(pressed.is_excited[1]);
    }
    for (const double value : pressed.value) EXPECT_TRUE(std::isfinite(value));
    // One sample moves a parameter by P phi error, and the leak keeps P <= 1 / prior_information in
    // scaled units. A small phi reveals covariance wind-up: the parameter would move by error /
    // phi.
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> small_phi{};
      small_phi[k] = 0.1 * std::sqrt(options.prior_information) * options.scale[k];
      const double before = estimator.parameters()[k];
      const double error = estimator.step(small_phi, pressed.value[k] * small_phi[k] + 1.0).error;
      const double max_gain =
          small_phi[k] / options.prior_information / std::pow(options.scale[k], 2);
      EXPECT_LE(std::abs(estimator.parameters()[k] - before), 1.0001 * max_gain * std::abs(error));
    }
    // Excited again, it converges at once instead of jumping.
    for (int i = 0; i < 200; ++i) {
      const auto phi = rich(0.01 * i);
      estimator.step(phi, dot(phi, truth) + 0.07 * random.normal());
    }
    EXPECT_NEAR(estimator.parameters()[0], 0.5, 0.25);
  }
}

TEST(ParameterEstimator, ZeroInputKeepsTheParameters) {
  for (const EstimationMethod method :
       {EstimationMethod::exponential, EstimationMethod::adaptive}) {
    ParameterEstimator<3> estimator(options_for(method), {1.0, 2.0, 3.0});
    for (int i = 0; i < 30000; ++i) estimator.step({0.0, 0.0, 0.0}, 0.0);
    EXPECT_NEAR(estimator.parameters()[2], 3.0, 1e-12);
    EXPECT_FALSE(estimator.estimate().is_excited[2]);
  }
}

TEST(ParameterEstimator, ReportsThatConstantSpeedDoesNotSeparateCoulombFromViscous) {
  EstimatorOptions<2> options;
  options.scale = {1.0, 0.03};
  ParameterEstimator<2> estimator(options);
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    estimator.step({1.0, 0.03 + 1e-4 * random.normal()}, 9.0 + 0.1 * random.normal());
  }
  const ParameterEstimate<2> estimate = estimator.estimate();
  EXPECT_FALSE(estimate.is_excited[0]);
  EXPECT_FALSE(estimate.is_excited[1]);
}

TEST(ParameterEstimator, IgnoresSamplesThatAreNotFiniteOrOutOfRange) {
  for (const EstimationMethod method : kMethods) {
    ParameterEstimator<3> estimator(options_for(method), {1.0, 2.0, 3.0});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(estimator.step({nan, 0.0, 0.0}, 1.0).was_used);
    EXPECT_FALSE(estimator.step({1.0, 0.0, 0.0}, nan).was_used);
    EXPECT_FALSE(estimator.step({1e300, 0.0, 0.0}, 1.0).was_used);
    EXPECT_EQ(estimator.parameters(), (std::array<double, 3>{1.0, 2.0, 3.0}));
  }
}

TEST(ParameterEstimator, RefusesOptionsOutOfTheirRange) {
  EstimatorOptions<3> options;
  options.forgetting = 1.5;
  EXPECT_THROW(ParameterEstimator<3>{options}, ContractError);
  options = {};
  options.scale[1] = 0.0;
  EXPECT_THROW(ParameterEstimator<3>{options}, ContractError);
  options = {};
  options.window = 3;
  EXPECT_THROW(ParameterEstimator<3>{options}, ContractError);
}

/// A press against mass, damper and spring whose stiffness doubles; how the estimator tracks it.
struct Tracking {
  double steady = 0.0;            ///< mean relative force error before and long after the step
  double recovery = 0.0;          ///< [s] from the step until the error stays under 10 %
  double share_forgetting = 0.0;  ///< of samples without a change at which lambda was below 1
  double min_forgetting = 1.0;
};

constexpr double kHalfWidth = 0.014;  // [s] of the filter
constexpr double kStepTime = 2.5;     // [s]
constexpr double kSlow = 2.0 * 3.14159265358979 * 0.5, kFast = 2.0 * 3.14159265358979 * 2.0;

double press_path(double t) {
  return 0.004 + 0.002 * std::sin(kSlow * t) + 0.0005 * std::sin(kFast * t);
}

double stepped_force(double t) {
  const double v = 0.002 * kSlow * std::cos(kSlow * t) + 0.0005 * kFast * std::cos(kFast * t);
  const double a =
      -0.002 * kSlow * kSlow * std::sin(kSlow * t) - 0.0005 * kFast * kFast * std::sin(kFast * t);
  const double x = press_path(t);
  return t < kStepTime ? 0.5 * a + 20.0 * v + 3000.0 * x : 0.5 * a + 60.0 * v + 6000.0 * x;
}

Tracking track_stiffness_step(EstimationMethod method, std::uint64_t seed) {
  EstimatorOptions<3> options = options_for(method);
  options.scale = {1.0, 0.03, 0.003};
  options.correlated_samples = correlated_samples(kHalfWidth, 0.002);
  options.noise_std = 0.3 / std::sqrt(options.correlated_samples);
  ParameterEstimator<3> estimator(options);
  Random random(seed);
  CausalFilter filter(kHalfWidth, 500.0, 0.3);
  Tracking result;
  double count = 0.0;
  for (int i = 0; i < 2500; ++i) {
    const double t = 0.002 * i;
    const auto out = filter.step(t, press_path(t) + 5e-6 * random.normal(),
                                 stepped_force(t) + 0.3 * random.normal());
    if (!out) continue;
    const EstimatorStep step =
        estimator.step({out->acceleration, out->speed, out->position}, out->force);
    const double noise_free = stepped_force(out->t);
    const double relative =
        std::abs(step.prediction - noise_free) / std::max(std::abs(noise_free), 1.0);
    if ((t > 0.5 && t < 2.4) || t > 3.5) {
      result.steady += relative;
      count += 1.0;
    }
    // Instants are those of the filter's output; its latency is added.
    if (out->t > kStepTime - kHalfWidth && relative > 0.1)
      result.recovery = out->t - kStepTime + filter.delay();
    result.min_forgetting = std::min(result.min_forgetting, step.forgetting);
    if (t > 0.5 && t < 2.4 && step.forgetting < 1.0) result.share_forgetting += 1.0 / 950.0;
  }
  result.steady /= count;
  return result;
}

TEST(AdaptiveForgetting, TracksAStiffnessStepWithoutFalseAlarms) {
  double steady = 0.0, recovery = 0.0;
  for (std::uint64_t seed = 6001; seed <= 6010; ++seed) {
    const Tracking adaptive = track_stiffness_step(EstimationMethod::adaptive, seed);
    steady += adaptive.steady / 10.0;
    recovery += adaptive.recovery / 10.0;
    EXPECT_LT(adaptive.recovery, 0.080);
    EXPECT_LT(adaptive.min_forgetting, 0.9);  // the change was detected,
    // without false alarms by noise, correlated by the filter: 950 samples at one in a million.
    EXPECT_EQ(adaptive.share_forgetting, 0.0);
  }
  RecordProperty("steady", std::to_string(steady));
  RecordProperty("recovery", std::to_string(recovery));
  EXPECT_LT(steady, 0.002);
  EXPECT_LT(recovery, 0.040);
}

TEST(AdaptiveForgetting, IsFasterThanExponentialAndMoreAccurateThanBlock) {
  const Tracking adaptive = track_stiffness_step(EstimationMethod::adaptive, 6021);
  const Tracking exponential = track_stiffness_step(EstimationMethod::exponential, 6021);
  const Tracking block = track_stiffness_step(EstimationMethod::block, 6021);
  EXPECT_LT(adaptive.recovery, exponential.recovery);
  EXPECT_LT(adaptive.steady, block.steady);
}

}  // namespace
}  // namespace pcavr
