// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/surface_offset.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/learned_friction.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

constexpr double kMaxOffset = 0.003;                                         // [m]
constexpr double kStd = 1e-4;                                                // [m]
constexpr double kForce = 5.0;                                               // [N]
const HuntCrossley kLaw{.stiffness = 1e4, .damping = 0.0, .exponent = 1.0};  // 0.5 mm at kForce

SurfaceOffset after_frames(int frames, double gap, double std = kStd) {
  SurfaceOffset offset(kMaxOffset);
  for (int i = 0; i < frames; ++i) offset.add(Eigen::Vector3d::UnitX(), gap, std, kForce);
  return offset;
}

TEST(SurfaceOffset, IsTheGapPlusThePenetrationByTheLaw) {
  const auto offset = after_frames(10, 1e-3).value(kLaw);
  ASSERT_TRUE(offset);
  EXPECT_NEAR(offset->x(), 1.5e-3, 1e-9);
  EXPECT_EQ(offset->tail<2>().norm(), 0.0);
}

TEST(SurfaceOffset, IsEmptyWhereTheLawExplainsTheGap) {
  EXPECT_FALSE(after_frames(10, -0.5e-3).value(kLaw));
  EXPECT_TRUE(after_frames(10, -0.5e-3).value({.stiffness = 1e6, .damping = 0.0, .exponent = 1.0}));
}

TEST(SurfaceOffset, IsEmptyForFewFramesForNoiseAndForAWrongPose) {
  EXPECT_FALSE(after_frames(3, 1e-3).value(kLaw));
  EXPECT_FALSE(after_frames(10, 1e-3, 1e-3).value(kLaw));
  EXPECT_FALSE(after_frames(10, 4e-3).value(kLaw));
}

TEST(SurfaceOffset, BeginsAnewOnTheOppositeFace) {
  SurfaceOffset offset = after_frames(10, 1e-3);
  offset.add(-Eigen::Vector3d::UnitX(), 0.0, kStd, kForce);
  EXPECT_FALSE(offset.value(kLaw));
}

TEST(SurfaceOffset, OfAWallLeavesThatOfTheFloor) {
  SurfaceOffset offset = after_frames(10, 1e-3);
  const Eigen::Vector3d floor(1e-4, 0.0, -2e-4);
  EXPECT_TRUE(offset.value(kLaw, floor)->isApprox(Eigen::Vector3d(1.5e-3, 0.0, -2e-4)));
  for (int i = 0; i < 10; ++i) offset.add(Eigen::Vector3d::UnitY(), -1.5e-3, kStd, kForce);
  EXPECT_TRUE(offset.value(kLaw, floor)->isApprox(Eigen::Vector3d(1.5e-3, -1e-3, -2e-4)));
}

/// The wall of an oblique hole is displaced by the tracked pose, which leaves the floor.
TEST(SurfaceOffset, OfAnInclinedWallDoesNotChangeTheHeightOfTheFloor) {
  const Eigen::Vector3d wall = Eigen::Vector3d(0.94, 0.0, 0.34).normalized();
  const Eigen::Vector3d floor(0.0, 0.0, -2e-4);
  SurfaceOffset offset(kMaxOffset);
  for (int i = 0; i < 10; ++i) offset.add(wall, 1e-4, kStd, kForce);
  const Eigen::Vector3d found = offset.value(kLaw, floor).value();
  EXPECT_NEAR(found.z(), floor.z(), 1e-12);
  EXPECT_NEAR(wall.dot(found), 0.6e-3, 1e-9);
  EXPECT_EQ(offset.value(kLaw)->z(), 0.0);
  // The height of a level face is measured.
  for (int i = 0; i < 10; ++i) offset.add(Eigen::Vector3d::UnitZ(), 0.0, kStd, kForce);
  EXPECT_NEAR(offset.value(kLaw, floor)->z(), 0.5e-3, 1e-9);
  EXPECT_NEAR(wall.dot(offset.value(kLaw, floor).value()), 0.6e-3, 1e-9);
}

ObjectParameters complete_parameters() {
  BodyPhysics physics;
  physics.friction.mass = 1.0;
  physics.friction.limiting_force = 5.0;
  physics.friction.coulomb_force = 4.0;
  physics.contact = kLaw;
  physics.friction_radius = 0.05;
  return sent_parameters(physics);
}

TEST(SurfaceOffset, IsSentWithTheContactParametersAndWithdrawnBeforeItIsAcknowledged) {
  const ObjectParameters acknowledged = complete_parameters();
  ObjectParameters now = acknowledged;
  EXPECT_FALSE(difference(now, acknowledged, nullptr).has_contact);
  now.contact_surface_offset = Eigen::Vector3d(0.001, 0.0, 0.0);
  const ParameterDifference changed = difference(now, acknowledged, nullptr);
  ASSERT_TRUE(changed.has_contact);
  EXPECT_EQ(changed.contact.contact_surface_offset, now.contact_surface_offset);
  // The law that was learned then explains the gap, while that message is on its way.
  const ParameterDifference withdrawn = difference(acknowledged, acknowledged, &changed.contact);
  ASSERT_TRUE(withdrawn.has_contact);
  EXPECT_EQ(*withdrawn.contact.contact_surface_offset, Eigen::Vector3d::Zero());
}

// The law of a first press is linear: the next one, of the exponent that was assumed before, may be
// sent before that one is acknowledged.
TEST(SentParameters, StateAContactLawWhole) {
  const ObjectParameters acknowledged = complete_parameters();
  ObjectParameters now = acknowledged;
  now.contact_stiffness->value *= 0.5;
  const ParameterDifference changed = difference(now, acknowledged, nullptr);
  ASSERT_TRUE(changed.has_contact);
  ASSERT_TRUE(changed.contact.contact_damping && changed.contact.contact_exponent);
  EXPECT_EQ(changed.contact.contact_exponent->value, acknowledged.contact_exponent->value);
}

TEST(SentParameters, RepeatFrictionThatAMessageInFlightChanges) {
  const ObjectParameters acknowledged = complete_parameters();
  ObjectParameters in_flight = acknowledged, now = acknowledged;
  in_flight.limiting_static_friction->value *= 2.0;
  now.sliding_friction_coefficient->value *= 1.5;
  const ParameterDifference changed = difference(now, acknowledged, &in_flight);
  ASSERT_TRUE(changed.friction.limiting_static_friction);
  EXPECT_EQ(changed.friction.limiting_static_friction->value,
            acknowledged.limiting_static_friction->value);
  EXPECT_FALSE(changed.friction.mass);
}

/// A slow slide under a rising force: by force and tip alone it looks like a soft contact.
TEST(OnlineIdentification, LearnsNoLawFromAPushThatMovedTheObjectUnnoticed) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  for (int i = 0; i < 1000; ++i) {
    t.push_back(0.002 * i);
    const double pressed = std::max(t.back() - 0.3, 0.0);
    tip.emplace_back(0.0025 * t.back(), 0.0, 0.0);
    force.emplace_back(2000.0 * 0.0025 * pressed, 0.0, 0.0);
  }
  for (const bool has_moved : {false, true}) {
    OnlineIdentification knowledge = knowledge_of_box({});
    knowledge.learn({t, force, t, tip, {}, 0.3, {.has_slid = false, .has_moved = has_moved}});
    EXPECT_EQ(knowledge.known().contact_stiffness.has_value(), !has_moved);
  }
}

/// The tip's path along an inclined wall, as in an oblique hole, is not its penetration, whether
/// the force is nearer to level, as of a push, or to upright, as of a press.
TEST(OnlineIdentification, LearnsNoLawFromAnInclinedFace) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  for (int i = 0; i < 1000; ++i) {
    t.push_back(0.002 * i);
    force.emplace_back(std::max(10.0 * (t.back() - 0.3), 0.0), 0.0, 0.0);
    tip.emplace_back(0.005 * t.back(), 0.0, 0.0);
  }
  for (const double slope : {0.0, 0.8, 1.4}) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      force[i].z() = -slope * force[i].x();
      tip[i].z() = -slope * tip[i].x();
    }
    OnlineIdentification knowledge = knowledge_of_box({});
    knowledge.learn({t, force, t, tip, {}, 0.3, {.has_slid = false, .has_moved = false}});
    EXPECT_EQ(knowledge.known().contact_stiffness.has_value(), slope == 0.0);
  }
}

}  // namespace
}  // namespace pcavr
