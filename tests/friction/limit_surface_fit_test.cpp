// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/limit_surface_fit.hpp"

#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "pcavr/base/core/median.hpp"

#include "friction/surfaces.hpp"
#include "support/option_defaults.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<PushSample> pushes_on(const LimitSurface& surface, int count, Random& random) {
  std::vector<PushSample> samples;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d wrench = random_vector(random).cwiseProduct(detail::scale_of(surface));
    samples.push_back({wrench / level(surface, wrench), sliding_direction(surface, wrench)});
  }
  return samples;
}

double median_angle(const LimitSurface& surface, const std::vector<PushSample>& samples,
                    double length) {
  std::vector<double> angles;
  for (const PushSample& sample : samples) {
    angles.push_back(twist_angle(sliding_direction(surface, sample.wrench), sample.twist, length));
  }
  return median(std::move(angles));
}

LimitSurfaceFit fit_as(SurfaceShape shape, const std::vector<PushSample>& samples) {
  LimitSurfaceFitOptions options;
  options.shape = shape;
  return fit_limit_surface(samples, options);
}

TEST(LimitSurfaceFit, RecoversAnEllipsoid) {
  Random random(20);
  const LimitSurface truth = ellipsoid_surface(4.2, 0.25, {0.005, -0.003});
  const auto samples = pushes_on(truth, 40, random);
  const LimitSurfaceFit fit = fit_as(SurfaceShape::ellipsoid, samples);
  ASSERT_EQ(fit.status, LimitSurfaceFitStatus::fitted);
  // The forms are 90 directions: their cone contains an ellipsoid up to a fraction of a percent.
  EXPECT_LT(median_angle(fit.surface, pushes_on(truth, 200, random), 0.06), 1.0 * kDegree);
  EXPECT_NEAR(level(fit.surface, {0.0, 0.0, 0.25}), level(truth, {0.0, 0.0, 0.25}), 0.02);
}

TEST(LimitSurfaceFit, QuarticFitsAQuarticBetterThanAnEllipsoid) {
  Random random(21);
  LimitSurface truth = ellipsoid_surface(5.0, 0.25);
  for (const Eigen::Vector3d& form :
       {Eigen::Vector3d(1.2, 0.3, 0.6), Eigen::Vector3d(-0.4, 0.9, 1)}) {
    const auto power = detail::TernaryForm<4>::power_of(form);
    for (std::size_t i = 0; i < truth.coefficients.size(); ++i) {
      truth.coefficients[i] += 2.0 * power[static_cast<Eigen::Index>(i)];
    }
  }
  const auto samples = pushes_on(truth, 60, random);
  const auto held_out = pushes_on(truth, 200, random);
  const LimitSurfaceFit ellipsoid = fit_as(SurfaceShape::ellipsoid, samples);
  const LimitSurfaceFit quartic = fit_as(SurfaceShape::quartic, samples);
  EXPECT_LT(median_angle(quartic.surface, held_out, 0.05), 2.0 * kDegree);
  EXPECT_LT(median_angle(quartic.surface, held_out, 0.05),
            0.5 * median_angle(ellipsoid.surface, held_out, 0.05));
}

TEST(LimitSurfaceFit, IsNearerToTheTruthByASupportThatIsKnown) {
  const LimitSurface truth = ellipsoid_surface(4.2, 0.25, {0.005, -0.003});
  LimitSurface larger = truth;
  larger.force *= 10.0;
  double angle = 0.0, angle_by_prior = 0.0;
  for (const std::uint64_t seed : {24, 25, 26, 27}) {
    Random random(seed);
    auto samples = pushes_on(truth, 20, random);
    for (PushSample& sample : samples) {
      sample.wrench += 0.2 * random_vector(random).cwiseProduct(detail::scale_of(truth));
    }
    const LimitSurfaceFit fit = fit_limit_surface(samples);
    const LimitSurfaceFit by_prior = fit_limit_surface(samples, {}, truth);
    const LimitSurfaceFit by_larger = fit_limit_surface(samples, {}, larger);
    const auto held_out = pushes_on(truth, 200, random);
    angle += median_angle(fit.surface, held_out, 0.06);
    angle_by_prior += median_angle(by_prior.surface, held_out, 0.06);
    // Only the prior's shape counts.
    EXPECT_NEAR(level(by_prior.surface, {1.0, 2.0, 0.1}), level(by_larger.surface, {1.0, 2.0, 0.1}),
                1e-6);
  }
  EXPECT_LT(angle_by_prior, 0.6 * angle);
}

TEST(LimitSurfaceFit, StaysConvexOnNoise) {
  Random random(22);
  std::vector<PushSample> samples;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d wrench = random_vector(random);
    samples.push_back({wrench, wrench + 2.0 * random_vector(random)});
  }
  const LimitSurfaceFit fit = fit_as(SurfaceShape::quartic, samples);
  ASSERT_EQ(fit.status, LimitSurfaceFitStatus::fitted);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d u = random_vector(random).normalized();
    const auto q = detail::evaluate_quartic(fit.surface.coefficients, u);
    const Eigen::Vector3d curvatures = q.hessian.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_GE(curvatures.minCoeff(), -1e-9 * curvatures.maxCoeff());
    EXPECT_GT(q.value, 0.0);
  }
}

TEST(LimitSurfaceFit, IsRobustAgainstAFewOutliers) {
  Random random(23);
  const LimitSurface truth = ellipsoid_surface(4.2, 0.25);
  auto samples = pushes_on(truth, 40, random);
  for (std::size_t i = 0; i < 4; ++i) samples[10 * i].twist *= -1.0;
  PushSample broken = samples.front();
  broken.wrench.x() = std::numeric_limits<double>::quiet_NaN();
  samples.push_back(broken);
  const LimitSurfaceFit fit = fit_as(SurfaceShape::ellipsoid, samples);
  EXPECT_EQ(fit.samples_used, 40);
  EXPECT_LT(median_angle(fit.surface, pushes_on(truth, 200, random), 0.06), 3.0 * kDegree);
}

TEST(LimitSurfaceFit, HasDocumentedDefaults) {
  test::expect_documented_defaults<LimitSurfaceFitOptions>();
}

TEST(LimitSurfaceFit, NeedsTheMinimumSpread) {
  Random random(25);
  const auto samples = pushes_on(ellipsoid_surface(4.2, 0.25), 40, random);
  LimitSurfaceFitOptions options;
  EXPECT_EQ(fit_limit_surface(samples, options).status, LimitSurfaceFitStatus::fitted);
  options.min_spread = 1.0;
  EXPECT_EQ(fit_limit_surface(samples, options).status, LimitSurfaceFitStatus::not_excited);
}

TEST(LimitSurfaceFit, AHeavyPriorMakesTheQuarticAnEllipsoid) {
  Random random(26);
  LimitSurface truth = ellipsoid_surface(5.0, 0.25);
  const auto power = detail::TernaryForm<4>::power_of({1.2, 0.3, 0.6});
  for (std::size_t i = 0; i < truth.coefficients.size(); ++i) {
    truth.coefficients[i] += 2.0 * power[static_cast<Eigen::Index>(i)];
  }
  const auto samples = pushes_on(truth, 60, random);
  LimitSurfaceFitOptions options;
  const double free = fit_limit_surface(samples, options).median_angle;
  options.prior_weight = 100.0;
  EXPECT_GT(fit_limit_surface(samples, options).median_angle, 1.5 * free);
}

TEST(LimitSurfaceFit, ReportsTooFewOrUnexcitedPushes) {
  Random random(24);
  const LimitSurface truth = ellipsoid_surface(4.2, 0.25);
  EXPECT_EQ(fit_limit_surface({}).status, LimitSurfaceFitStatus::too_few_pushes);
  EXPECT_EQ(fit_limit_surface(pushes_on(truth, 14, random)).status,
            LimitSurfaceFitStatus::too_few_pushes);
  auto straight = pushes_on(truth, 40, random);
  for (PushSample& sample : straight) {
    sample.wrench.z() = 0.0;
    sample.twist.z() = 0.0;
  }
  EXPECT_EQ(fit_limit_surface(straight).status, LimitSurfaceFitStatus::not_excited);
}

TEST(LimitSurfaceFit, IsDeterministic) {
  Random random(25);
  const auto samples = pushes_on(random_surface(random), 40, random);
  const LimitSurfaceFit one = fit_limit_surface(samples);
  const LimitSurfaceFit other = fit_limit_surface(samples);
  EXPECT_EQ(std::memcmp(&one.surface, &other.surface, sizeof one.surface), 0);
}

}  // namespace
}  // namespace pcavr
