// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The direction that a force must have, from the motion of a body that turns as it is pushed.
#include "physics/inputs/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"

#include "physics/inputs/force_turn.hpp"
#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kSlidingTip = 0.01;  // [m] of the tip
constexpr double kTipHeight = 0.02;   // [m] over the body's middle, which is 25 mm over the support
constexpr double kMass = 2.0;         // [kg]
constexpr double kForce = 16.0;       // [N] of a friction coefficient of 0.82
constexpr double kSlideTime = 1.0;    // [s]

/// A block that slides along the force's +y at its centre of pressure, which lies ahead of the
/// centre of mass, and turns by `rate` [rad/s].
Pose pose_at_time(double t, double rate) {
  const double ahead = (kTipHeight + 0.025) * kForce / (kMass * kStandardGravity);
  const Eigen::Vector3d velocity(rate * ahead, 0.012, 0.0);  // of the centre of mass
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(rate * t, Eigen::Vector3d::UnitZ())),
              t * velocity);
}

/// Pushes of the face at y = -50 mm near one of its corners, one after the other.
std::vector<ContactEvidence> evidence_of(const std::vector<double>& rates,
                                         std::optional<double> mass) {
  const CadModel model =
      make_cad_model(test::box_mesh({0.1F, 0.1F, 0.05F}), "block", "test").value();
  std::vector<TrackedPose> tracked;
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<Contact> contacts;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    Contact& contact = contacts.emplace_back();
    contact.kind = ContactKind::slide;
    contact.object = 0;
    contact.begin = 10.0 * static_cast<double>(k);
    contact.end = contact.begin + kSlideTime;
    contact.peak_force = kForce;
    contact.normal_object = -Eigen::Vector3d::UnitY();
    const double corner = rates[k] < 0.0 ? -0.045 : 0.045;
    for (double t = 0.0; t < kSlideTime; t += 0.005) {
      const Pose T = pose_at_time(t, rates[k]);
      tracked.push_back({contact.begin + t, T, 1e-4, 1e-3});
      t_tool.push_back(contact.begin + t);
      p_base_tip.push_back(T * Eigen::Vector3d(corner, -0.05 - kSlidingTip, kTipHeight));
      contact.t.push_back(contact.begin + t);
      contact.force_base.push_back(kForce * Eigen::Vector3d::UnitY());
    }
  }
  InputSeries series{.bodies = {{"block", &model, Pose(), mass, tracked}},
                     .tool_radius = kSlidingTip,
                     .t_tool = t_tool,
                     .p_base_tip = p_base_tip};
  std::vector<BodySurface> surfaces;
  surfaces.emplace_back(model);
  return gather_evidence(series, contacts, PathView(t_tool, p_base_tip),
                         BodyPoses(series.bodies, surfaces));
}

/// [rad] Between the force and the direction that it must have.
double angle_of(const ForceDirection& direction) {
  return std::acos(std::min(1.0, direction.force_base.dot(direction.expected_base)));
}

TEST(Evidence, ExpectsTheForceAlongTheMotionOfTheCentreOfPressure) {
  for (const double rate : {0.2, -0.2}) {
    const std::vector<ContactEvidence> evidence = evidence_of({rate}, kMass);
    ASSERT_EQ(evidence.size(), 1U);
    ASSERT_TRUE(evidence[0].direction);
    EXPECT_LT(angle_of(*evidence[0].direction), 2.0 * kDegree);
  }
}

TEST(Evidence, DoubtsTheMotionOfACentreThatIsNotKnownWithoutTheWeight) {
  const std::vector<ContactEvidence> turning = evidence_of({0.2}, std::nullopt);
  const std::vector<ContactEvidence> straight = evidence_of({0.0}, std::nullopt);
  ASSERT_TRUE(turning.at(0).direction && straight.at(0).direction);
  EXPECT_LT(angle_of(*straight[0].direction), 1.0 * kDegree);
  EXPECT_LT(straight[0].direction->across_std, 5.0 * kDegree);
  EXPECT_GT(angle_of(*turning[0].direction), 10.0 * kDegree) << "or there is nothing to doubt";
  EXPECT_LT(angle_of(*turning[0].direction), 1.2 * turning[0].direction->across_std);
}

// By the motion of the centre of mass, mirrored forces would explain pushes at both corners.
TEST(Evidence, OfPushesAtCornersAccusesNoSensor) {
  for (const std::optional<double> mass : {std::optional(kMass), std::optional<double>()}) {
    const TurnFinding found = state_force_turn(evidence_of({0.2, -0.2, 0.2, 0.2, -0.2, 0.2}, mass));
    EXPECT_FALSE(found.error.has_value()) << found.error->to_string();
    EXPECT_EQ(found.note, "");
  }
}

}  // namespace
}  // namespace pcavr
