// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The support's pressure under a push above it, and the friction radius of an object that turns.
#include "pcavr/turning/support.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "pcavr/friction/point_push.hpp"
#include "pcavr/turning/turning.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kHalf = 0.05;  // [m] of the block's side

CadModel block() {
  return make_cad_model(test::box_mesh({0.1F, 0.1F, 0.1F}), "block", "test").value();
}
Support support_of(const CadModel& model) { return {model, Pose()}; }

Eigen::Vector2d centre_of(const Support& support, const std::vector<double>& shares) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < shares.size(); ++i) centre += shares[i] * support.points()[i];
  return centre;
}

TEST(Support, HasTheRadiusOfItsLowestFace) {
  // Of a square, 0.7652 of half its side.
  EXPECT_NEAR(support_of(block()).radius(), 0.7652 * kHalf, 0.01 * kHalf);
  EXPECT_NEAR(support_height(block(), Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0})), 0.95,
              1e-6);
}

TEST(Support, BearsTheLoadAboutItsCentreOfPressure) {
  const Support support = support_of(block());
  for (const double ahead : {0.0, 0.01, 0.03}) {  // beyond a third of half the side, a part lifts
    const Eigen::Vector2d centre(ahead, -0.3 * ahead);
    const std::vector<double> shares = support.pressure(centre);
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-9);
    EXPECT_LT((centre_of(support, shares) - centre).norm(), 0.001) << ahead;
    EXPECT_EQ(*std::min_element(shares.begin(), shares.end()) == 0.0, ahead == 0.03) << ahead;
  }
}

TEST(Support, BearsNoLoadBeyondItsEdge) {
  const Support support = support_of(block());
  const double reached = centre_of(support, support.pressure({0.2, 0.0})).x();
  EXPECT_GT(reached, 0.5 * kHalf);
  EXPECT_LT(reached, kHalf);
}

TEST(Support, MovesThePressureAheadByHeightAndForceOverWeight) {
  const Eigen::Vector2d force(0.0, 4.0);
  EXPECT_NEAR(centre_of_pressure(force, 0.05, 10.0).y(), 0.02, 1e-12);
  // Of a typical weight where none is known.
  EXPECT_NEAR(centre_of_pressure(force, 0.05, {}).y(), 0.015, 1e-12);
  EXPECT_TRUE(centre_of_pressure(Eigen::Vector2d::Zero(), 0.05, {}).isZero());
}

/// Pushes along +y, each with some twists about the centre of pressure, which lies `ahead` [m];
/// `to` is what the samples are about.
SamplesOfPushes pushes_of(const Support& support, double ahead, const Eigen::Vector2d& to) {
  const Eigen::Vector2d centre(0.0, ahead);
  const std::vector<double> shares = support.pressure(centre);
  SamplesOfPushes pushes;
  for (const double lever : {0.012, -0.02, 0.03, -0.015, 0.025, -0.03}) {
    std::vector<PushSample>& push = pushes.emplace_back();
    for (const double spread : {0.8, 0.9, 1.0, 1.1}) {
      const Eigen::Vector3d twist(0.001 * spread * lever / 0.03, 0.004, 8.0 * spread * lever * 0.1);
      PushSample sample;
      sample.twist << velocity_of(to - centre, twist), twist.z();
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const Eigen::Vector2d arm = support.points()[i] - centre;
        const Eigen::Vector2d force = shares[i] * velocity_of(arm, twist).normalized();
        sample.wrench += wrench_of(force, support.points()[i] - to);
      }
      sample.centre_of_pressure = to;
      push.push_back(sample);
    }
  }
  return pushes;
}

double radius_of(const CadModel& model, const SamplesOfPushes& pushes) {
  const std::vector<TrackedPose> tracked{{0.0, Pose()}};
  const TurningFriction found = identify_turning(pushes, {model, tracked}, {});
  return found.radius ? found.radius->value : 0.0;
}

TEST(Turning, FindsTheRadiusUnderAPressureThatThePushesMoveAhead) {
  const CadModel model = block();
  for (const double size : {1.0, 0.7}) {
    const Support support = support_of(model).scaled(size);
    for (const double ahead : {0.0, 0.4 * size * kHalf}) {
      const double found = radius_of(model, pushes_of(support, ahead, {0.0, ahead}));
      EXPECT_NEAR(found, support.radius(), 0.03 * support.radius()) << size << ", " << ahead;
    }
  }
}

TEST(Turning, WithoutThePressuresMotionTheRadiusIsTooSmall) {
  const CadModel model = block();
  const Support support = support_of(model);
  const double found = radius_of(model, pushes_of(support, 0.4 * kHalf, {0.0, 0.0}));
  EXPECT_LT(found, 0.93 * support.radius());
}

}  // namespace
}  // namespace pcavr
