// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/friction/limit_surface_fit.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "pcavr/core/median.hpp"

#include "friction/push_recording.hpp"
#include "friction/surfaces.hpp"
#include "support/shared_data.hpp"

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
  // The forms are 90 directions: their cone holds an ellipsoid up to a fraction of a percent.
  EXPECT_LT(median_angle(fit.surface, pushes_on(truth, 200, random), 0.06), 1.0 * kDegree);
  EXPECT_NEAR(level(fit.surface, {0.0, 0.0, 0.25}), level(truth, {0.0, 0.0, 0.25}), 0.02);
}

TEST(LimitSurfaceFit, QuarticComesNearerToAQuarticThanAnEllipsoidDoes) {
  Random random(21);
  LimitSurface truth = ellipsoid_surface(5.0, 0.25);
  for (const Eigen::Vector3d& form :
       {Eigen::Vector3d(1.2, 0.3, 0.6), Eigen::Vector3d(-0.4, 0.9, 1)}) {
    const auto power = detail::fourth_power_of(form);
    for (std::size_t i = 0; i < power.size(); ++i) truth.coefficients[i] += 2.0 * power[i];
  }
  const auto samples = pushes_on(truth, 60, random);
  const auto unseen = pushes_on(truth, 200, random);
  const LimitSurfaceFit ellipsoid = fit_as(SurfaceShape::ellipsoid, samples);
  const LimitSurfaceFit quartic = fit_as(SurfaceShape::quartic, samples);
  EXPECT_LT(median_angle(quartic.surface, unseen, 0.05), 2.0 * kDegree);
  EXPECT_LT(median_angle(quartic.surface, unseen, 0.05),
            0.5 * median_angle(ellipsoid.surface, unseen, 0.05));
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

TEST(LimitSurfaceFit, IsNotMovedFarByAFewWildPushes) {
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

TEST(LimitSurfaceFit, SaysWhereThePushesDoNotTellEnough) {
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

TEST(LimitSurfaceFit, IsTheSameEveryTime) {
  Random random(25);
  const auto samples = pushes_on(random_surface(random), 40, random);
  const LimitSurfaceFit one = fit_limit_surface(samples);
  const LimitSurfaceFit other = fit_limit_surface(samples);
  EXPECT_EQ(std::memcmp(&one.surface, &other.surface, sizeof one.surface), 0);
}

/// Real pushes of a block on seven supports, each quarter held out in turn.
struct Judgement {
  double heading = 0.0;  ///< median twist direction error of held-out pushes [rad]
  double force = 0.0;    ///< mean force that the surface of all pushes bears without turning [N]
};

Judgement judge(const std::string& name, SurfaceShape shape) {
  const PushRecording recording(shared_data("real/push_cmu") / name);
  std::vector<PushSample> all;
  for (std::size_t i = 0; i < recording.size(); ++i) all.push_back(recording.sample(i));
  std::vector<double> angles;
  for (std::size_t fold = 0; fold < 4; ++fold) {
    std::vector<PushSample> train, test;
    for (std::size_t i = 0; i < all.size(); ++i) (i % 4 == fold ? test : train).push_back(all[i]);
    const LimitSurface surface = fit_as(shape, train).surface;
    for (const PushSample& sample : test) {
      // A turn of 1 rad counts 50 mm: the lower of the block's characteristic lengths.
      angles.push_back(twist_angle(sliding_direction(surface, sample.wrench), sample.twist, 0.05));
    }
  }
  Judgement result;
  result.heading = median(std::move(angles));
  const LimitSurface surface = fit_as(shape, all).surface;
  for (int i = 0; i < 36; ++i) {
    const double angle = 10.0 * kDegree * i;
    result.force +=
        sliding_load(surface, {std::cos(angle), std::sin(angle), 0.0}).head<2>().norm() / 36.0;
  }
  return result;
}

TEST(RealPushes, OfEverySupportTurnWithinTenDegreesOfTheQuartic) {
  PCAVR_NEEDS_SHARED_DATA("real/push_cmu");
  for (const char* name :
       {"patch__exp_08_18_1435_50.txt", "10_130_10_10_10_130__exp_08_17_50.txt",
        "10_90_10_10_30_130__exp_08_11_30.txt", "10_90_10_10_30_130__exp_08_15_50.txt",
        "30_63.33_43.33_30_43.33_63.33__exp_08_17_50.txt", "30_90_30_30_30_90__exp_08_11_30.txt",
        "30_90_30_30_30_90__exp_08_11_50_mixed.txt"}) {
    const Judgement quartic = judge(name, SurfaceShape::quartic);
    const Judgement ellipsoid = judge(name, SurfaceShape::ellipsoid);
    RecordProperty(std::string(name) + " heading_deg", std::to_string(quartic.heading / kDegree));
    EXPECT_LT(quartic.heading, 10.0 * kDegree) << name;
    EXPECT_LT(quartic.heading, ellipsoid.heading) << name;
  }
}

TEST(RealPushes, OnAnEvenPatchTurnWithinSixDegreesAndBearTheMeasuredForce) {
  PCAVR_NEEDS_SHARED_DATA("real/push_cmu");
  const Judgement patch = judge("patch__exp_08_18_1435_50.txt", SurfaceShape::quartic);
  EXPECT_LT(patch.heading, 6.0 * kDegree);
  EXPECT_NEAR(patch.force, 4.2, 0.04 * 4.2);  // as its makers report it
}

}  // namespace
}  // namespace pcavr
