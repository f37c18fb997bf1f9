// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/breakaway_lever.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "identification/plant.hpp"
#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kToolRadius = 0.005;  // [m]

/// Pushes of a tracked box along x. Where the force has another direction than its face's normal,
/// it passes the centre of mass at a distance.
class Pushes {
 public:
  explicit Pushes(const Plant& plant) : plant_(plant) {
    model_.mesh_object = test::box_mesh({0.16F, 0.16F, 0.10F});
  }

  /// Adds a push at 4 mm/s whose force has the lever arm `lever` [m].
  void add_slow(double lever, std::uint64_t seed) {
    const Trial trial =
        run(plant_, kSensors, 2.5, seed, [](double t) { return 0.004 * (t - 0.3); });
    add(trial, [lever](double) { return lever; });
  }
  /// Accelerated from rest; the lever arm is `lever` [m] until shortly before the peak.
  void add_accelerated(double lever, std::uint64_t seed) {
    const Trial trial = run(plant_, kSensors, 1.0, seed,
                            [](double t) { return 0.075 * (t - 0.3) * std::abs(t - 0.3); });
    const double to = find_breakaway(trial.series()).t - 0.022;
    add(trial, [=](double t) { return t < to ? lever : 0.0; });
  }

  ObjectIdentification identify() {
    ObjectIdentification found;
    found.parameters.mass = ParameterValue{plant_.mass, {}};
    const PathView tip(t_, p_base_tip_);
    identify_friction_of(contacts_, 0, plant_.mass, {model_, tracked_}, tip, kToolRadius, {},
                         found);
    return found;
  }

 private:
  static constexpr double kHalfSide = 0.08;
  static constexpr Sensors kSensors{.force_noise = 0.05};

  /// `lever`: the lever arm [m] at a time of the trial.
  template <typename Lever>
  void add(const Trial& trial, const Lever& lever) {
    Contact push;
    push.object = 0;
    push.normal_object = -Eigen::Vector3d::UnitX();
    push.kind = ContactKind::slide;
    push.direction_base = Eigen::Vector3d::UnitX();
    const double start = t_.empty() ? 0.0 : t_.back() + 0.002;
    for (std::size_t i = 0; i < trial.t.size(); ++i) {
      const double t = start + trial.t[i];
      t_.push_back(t);
      // The face is 80 mm before the centre.
      const double angle = std::asin(lever(trial.t[i]) / kHalfSide);
      push.force_base.emplace_back(trial.force[i], -trial.force[i] * std::tan(angle), 0.0);
      push.t.push_back(t);
      push.tool.push_back(travelled_ + trial.tool[i]);
      p_base_tip_.emplace_back(travelled_ + trial.tool[i] - kHalfSide - kToolRadius, 0.0, 0.05);
      if (i % 16 != 0) continue;
      const Eigen::Vector3d centre(travelled_ + trial.object[i], 0.0, 0.05);
      tracked_.push_back({t, Pose(Eigen::Quaterniond::Identity(), centre), 2e-4, 1e-3});
    }
    travelled_ += trial.object.back();
    push.force = trial.force;
    push.begin = start + 0.3;
    push.end = t_.back();
    push.peak_force = *std::max_element(push.force.begin(), push.force.end());
    push.breakaway = find_breakaway(push.series());
    contacts_.push_back(std::move(push));
  }

  Plant plant_;
  CadModel model_;
  std::vector<Contact> contacts_;
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> p_base_tip_;
  std::vector<TrackedPose> tracked_;
  double travelled_ = 0.0;
};

const Plant kBox{.mass = 1.5, .coulomb = 6.0, .breakaway = 7.0, .viscous = 5.0};

TEST(YieldInstant, IsWhereTheForceReachesCoulombFrictionForGood) {
  Contact contact;
  for (int i = 0; i < 500; ++i) {
    const double t = 0.002 * i;
    contact.t.push_back(t);
    // The force is above 3 N from 0.16 to 0.20 s, then again from 0.60 s on, up to the peak at 0.9
    // s.
    contact.force.push_back(t < 0.2 ? 20.0 * t - 0.2 : t < 0.3 ? 1.0 : 5.0 * std::min(t, 0.9));
  }
  contact.breakaway.t = 0.9;
  EXPECT_NEAR(yield_instant(contact, 3.0), 0.60, 0.005);
  EXPECT_DOUBLE_EQ(yield_instant(contact, 5.0), 0.9);
}

TEST(LimitWithMoment, IsTheLengthOfForceAndMomentByTheFrictionRadius) {
  const LimitOfMotion limit{{3.0, 0.1, true}, 0.0};
  const LimitOfMotion found = limit_with_moment(limit, 0.03, {0.04, 0.01, true});
  EXPECT_NEAR(found.limit.value, 3.75, 1e-12);
  EXPECT_NEAR(found.limit.std, 0.125, 1e-12);
  const double larger = limit_with_moment(limit, 0.03, {0.04001, 0.01, true}).limit.value;
  EXPECT_NEAR(found.shared_std, (found.limit.value - larger) / 1e-5 * 0.01, 1e-3);
}

TEST(LimitWithMoment, GivesTheLimitOfSlowPushesWhereNoneIsThroughTheCentre) {
  constexpr double kLever = 0.02;
  // The same forces with and without a lever arm: those with one have moved a higher limit.
  Pushes off_centre(kBox), centred(kBox);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    off_centre.add_slow(kLever, seed);
    centred.add_slow(0.0, seed);
  }
  const auto limit = off_centre.identify().parameters.limiting_static_friction;
  const auto centred_limit = centred.identify().parameters.limiting_static_friction;
  ASSERT_TRUE(limit && centred_limit);
  // The mean distance from the centre of a square.
  const double radius = 0.16 * (std::numbers::sqrt2 + std::asinh(1.0)) / 6.0;
  EXPECT_NEAR(limit->value, std::hypot(1.0, kLever / radius) * centred_limit->value,
              0.01 * limit->value);
  EXPECT_GT(*limit->std, *centred_limit->std);  // the radius is an assumption
}

// Inertia makes the peak of an accelerated push, when its force already passes the centre of mass;
// it did not when the object broke away.
TEST(LimitWithMoment, DoesNotCountAnAcceleratedPushThatBreaksAwayOffTheCentre) {
  Pushes pushes(kBox);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) pushes.add_slow(0.02, seed);
  pushes.add_accelerated(0.02, 4);
  EXPECT_EQ(pushes.identify().limit.pushes, 3);

  Pushes centred(kBox);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) centred.add_slow(0.02, seed);
  centred.add_accelerated(0.0, 4);
  EXPECT_EQ(centred.identify().limit.pushes, 1);
}

}  // namespace
}  // namespace pcavr
