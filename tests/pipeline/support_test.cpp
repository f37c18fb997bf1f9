// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The support's pressure under a push above it, and the friction radius of an object that turns.
#include "pcavr/physics/turning/support.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/friction/standing.hpp"
#include "pcavr/physics/turning/turning.hpp"

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
  // The radius of a square is 0.7652 of half its side.
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

TEST(Support, IsBorneEvenlyOnAPointOrAnEdge) {
  // A tracker's flipped pose may be tipped so.
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(1.0, 0.6, 0.2)}) {
    const Pose tipped(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, axis.normalized())),
                      {0.0, 0.0, 0.0});
    const Support support(block(), tipped);
    for (const double ahead : {1e-3, 0.02, 0.3}) {
      const std::vector<double> shares = support.pressure({ahead, -0.3 * ahead});
      EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-9) << ahead;
    }
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
  // The weight is a typical one where none is known.
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

std::optional<ParameterValue> radius_by(const CadModel& model, const SamplesOfPushes& pushes,
                                        const ParameterValue& viscous) {
  const std::vector<TrackedPose> tracked{{0.0, Pose()}};
  return identify_turning(pushes, {model, tracked}, viscous, {}).radius;
}

double radius_of(const CadModel& model, const SamplesOfPushes& pushes) {
  const std::optional<ParameterValue> found = radius_by(model, pushes, {});
  return found ? found->value : 0.0;
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

/// The pushes under Coulomb friction of 1 N, and at each point viscous friction `b` [N s/m] too.
SamplesOfPushes with_viscous_friction(SamplesOfPushes pushes, const Support& support, double b) {
  const double share = b / static_cast<double>(support.points().size());
  for (std::vector<PushSample>& push : pushes) {
    for (PushSample& sample : push) {
      for (const Eigen::Vector2d& p : support.points()) {
        sample.wrench += wrench_of(share * velocity_of(p, sample.twist), p);
      }
    }
  }
  return pushes;
}

TEST(Turning, FindsTheRadiusBesideViscousFriction) {
  const CadModel model = block();
  for (const double size : {1.0, 0.7}) {
    const Support support = support_of(model).scaled(size);
    constexpr double kViscous = 60.0;  // [N s/m] a fifth of the load at 4 mm/s
    const SamplesOfPushes pushes =
        with_viscous_friction(pushes_of(support, 0.0, {0.0, 0.0}), support, kViscous);
    const double truth = support.radius();
    const auto found = radius_by(model, pushes, {kViscous, {}});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->value, truth, 0.02 * truth) << size;
    EXPECT_GT(radius_of(model, pushes), 1.04 * truth) << size;
    // The radius is not known if viscous friction is not.
    const auto unsure = radius_by(model, pushes, {0.0, kViscous});
    ASSERT_TRUE(unsure);
    EXPECT_LT(std::abs(unsure->value - truth), 1.5 * *unsure->std) << size;
  }
}

TEST(Turning, MeasuresTwistsAsRates) {
  const CadModel model = block();
  const Eigen::Vector2d velocity(0.03, 0.01);
  constexpr double kRate = 0.4;  // [rad/s]
  std::vector<TrackedPose> tracked;
  for (int i = 0; i <= 30; ++i) {
    const double t = i / 30.0;
    const Eigen::Quaterniond q(Eigen::AngleAxisd(kRate * t, Eigen::Vector3d::UnitZ()));
    tracked.push_back({t, Pose(q, {velocity.x() * t, velocity.y() * t, 0.05})});
  }
  Contact push;
  push.normal_object = -Eigen::Vector3d::UnitX();
  std::vector<double> t;
  std::vector<Eigen::Vector3d> p_base_tip;
  for (int i = 0; i <= 500; ++i) {
    t.push_back(i / 500.0);
    p_base_tip.emplace_back(-0.06 + velocity.x() * t.back(), 0.0, 0.05);
    push.force_base.emplace_back(2.0, 0.0, 0.0);
  }
  push.t = t;
  push.slides = {{0.0, 1.0}};
  const std::vector<PushSample> samples =
      turning_samples(push, {model, tracked}, PathView(t, p_base_tip), 0.01, 1e6);
  ASSERT_GE(samples.size(), 3U);
  for (const PushSample& sample : samples) {
    EXPECT_NEAR(sample.twist.head<2>().norm(), velocity.norm(), 1e-3 * velocity.norm());
    EXPECT_NEAR(sample.twist.z(), kRate, 1e-9);
  }
}

TEST(Turning, KnowsHowEvenPressureWouldHaveTurnedTheObject) {
  const CadModel model = block();
  const Support support = support_of(model);
  const LimitSurface even = surface_of_support(model, Pose(), support.radius());
  const auto mean_angle = [&](const std::vector<PushSample>& samples) {
    double sum = 0.0;
    for (const PushSample& sample : samples) {
      const Eigen::Vector3d twist = sliding_direction(even, sample.wrench);
      sum += twist_angle(twist, sample.twist, support.radius());
    }
    return sum / static_cast<double>(samples.size());
  };
  const std::vector<PushSample> pushes =
      joined(pushes_of(support, 0.4 * kHalf, {0.0, 0.4 * kHalf}));
  EXPECT_LT(mean_angle(of_even_pressure(pushes, support)), 0.6 * mean_angle(pushes));
  const std::vector<PushSample> low = joined(pushes_of(support, 0.0, {0.0, 0.0}));
  EXPECT_NEAR(mean_angle(of_even_pressure(low, support)), mean_angle(low), 1e-9);
}

TEST(Turning, WithholdsARadiusThatPushesDisagreeOn) {
  // Two pushes as of a support of a third of the size, and one as of the whole.
  const CadModel model = block();
  const SamplesOfPushes small = pushes_of(support_of(model).scaled(0.3), 0.0, {0.0, 0.0});
  const SamplesOfPushes whole = pushes_of(support_of(model), 0.0, {0.0, 0.0});
  EXPECT_EQ(radius_of(model, {small[1], whole[2], small[4]}), 0.0);
  EXPECT_GT(radius_of(model, {whole[1], whole[2], whole[4]}), 0.0);
}

TEST(Turning, WithoutThePressuresMotionTheRadiusIsTooSmall) {
  const CadModel model = block();
  const Support support = support_of(model);
  const double found = radius_of(model, pushes_of(support, 0.4 * kHalf, {0.0, 0.0}));
  EXPECT_LT(found, 0.93 * support.radius());
}

/// Shares of pressure that differs by 60 % between patches a quarter of the support wide, and is
/// centred under the centre of mass.
std::vector<double> uneven_pressure(const Support& support, Random& random) {
  double patches[4][4];
  for (auto& row : patches) {
    for (double& patch : row) patch = std::max(0.0, 1.0 + 0.6 * random.normal());
  }
  std::vector<double> shares;
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  Eigen::Vector3d excess = Eigen::Vector3d::Zero();
  const auto row_of = [](const Eigen::Vector2d& p) { return Eigen::Vector3d(1.0, p.x(), p.y()); };
  for (const Eigen::Vector2d& p : support.points()) {
    const Eigen::Array2d at = (p.array() + kHalf) * (2.0 / kHalf);
    shares.push_back(patches[static_cast<int>(at.x())][static_cast<int>(at.y())] /
                     static_cast<double>(support.points().size()));
    sums += row_of(p) * row_of(p).transpose();
    excess += shares.back() * row_of(p);
  }
  const Eigen::Vector3d plane = sums.ldlt().solve(excess - Eigen::Vector3d::UnitX());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i] = std::max(0.0, shares[i] - plane.dot(row_of(support.points()[i])));
  }
  return shares;
}

TEST(Turning, MissesTheRadiusOfUnevenPressureByTwoPerCent) {
  Random random(3);
  const CadModel model = block();
  const Support support = support_of(model);
  double squares = 0.0;
  constexpr int kSupports = 20;
  for (int k = 0; k < kSupports; ++k) {
    const std::vector<double> shares = uneven_pressure(support, random);
    double sum = 0.0, radius = 0.0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      sum += shares[i];
      radius += shares[i] * support.points()[i].norm();
    }
    std::vector<PushSample> samples(12);
    for (PushSample& sample : samples) {
      const double side = random.uniform(-1.0, 1.0) > 0.0 ? 1.0 : -1.0;
      sample.twist << random.normal(), random.normal(), side * random.uniform(5.0, 20.0);
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const Eigen::Vector2d& p = support.points()[i];
        sample.wrench += wrench_of(shares[i] * velocity_of(p, sample.twist).normalized(), p);
      }
    }
    const std::optional<Support> found = scaled_to_pushes(support, samples);
    ASSERT_TRUE(found);
    squares += std::pow(found->radius() * sum / radius - 1.0, 2);
  }
  // friction_radius.cpp: kPressureShare, what the std of a radius has for this.
  EXPECT_NEAR(std::sqrt(squares / kSupports), 0.02, 0.006);
}

}  // namespace
}  // namespace pcavr
