// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kRadius = 0.02;       // [m] of the tip
constexpr double kNormalForce = 4.0;   // [N]
constexpr double kTrackedStep = 0.03;  // [s]
constexpr double kForceStep = 0.005;   // [s]

/// State of a push along y at a time: the block's pose, and the tip's centre beside the face at y =
/// -50 mm along x, in the object's frame [m].
struct PushState {
  Pose T_base_object;
  double x = 0.0;
  double friction = 0.0;  ///< along the face over the normal force
};
using Push = std::function<PushState(double)>;

/// A block that is pushed 2.5 mm/s fast, `share` of it along the face: 6 s.
PushState slow_push(double t, double share, double friction) {
  const double path = 0.0025 * t;
  const Eigen::Vector3d moved(0.0, std::sqrt(1.0 - share * share) * path, 0.0);
  return {Pose(Eigen::Quaterniond::Identity(), moved), share * path, friction};
}

/// What is found from pushes, each of which lasts `duration` [s]. `turn` [rad]: of the tracked
/// frame against the block's, about z.
ObjectIdentification identified_from(const std::vector<Push>& pushes, double duration,
                                     double turn = 0.0) {
  const Pose T_object_tracked(Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())),
                              Eigen::Vector3d::Zero());
  const CadModel model =
      make_cad_model(test::box_mesh({0.1F, 0.1F, 0.05F}), "block", "test").value();
  Random random(5);
  std::vector<TrackedPose> tracked;
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<Contact> contacts;
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    const double begin = static_cast<double>(k) * (duration + 10.0);
    Contact& contact = contacts.emplace_back();
    contact.object = 0;
    contact.begin = begin;
    contact.end = begin + duration;
    for (double t = 0.0; t < duration; t += kTrackedStep) {
      const Pose T = pushes[k](t).T_base_object;
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      tracked.push_back({begin + t,
                         Pose(T.rotation(), T.translation() + 1e-4 * noise) * T_object_tracked,
                         1e-4, 1e-3});
    }
    for (double t = 0.0; t < duration; t += kForceStep) {
      const PushState now = pushes[k](t);
      t_tool.push_back(begin + t);
      p_base_tip.push_back(now.T_base_object * Eigen::Vector3d(now.x, -0.05 - kRadius, 0.0));
      contact.t.push_back(begin + t);
      const Eigen::Vector3d force(now.friction + 0.02 * random.normal(), 1.0, 0.0);
      contact.force_base.push_back(now.T_base_object.rotation() * (kNormalForce * force));
    }
  }
  ObjectIdentification result;
  identify_tool_friction_of(contacts, 0, {model, tracked}, BodySurface(model),
                            PathView(t_tool, p_base_tip), kRadius, result);
  return result;
}
std::optional<ParameterValue> found_from(const std::vector<Push>& pushes, double duration) {
  return identified_from(pushes, duration).parameters.tool_friction_coefficient;
}

void expect_value(const std::optional<ParameterValue>& found, double truth) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, truth, 0.03 * truth);
  EXPECT_NEAR(found->value, truth, 3.0 * *found->std);
}

TEST(IdentifyToolFriction, IsFoundFromATipThatSlidesSlowly) {
  for (const double share : {0.4, 0.8}) {
    const Push push = [share](double t) { return slow_push(t, share, 0.4); };
    expect_value(found_from({push, push, push}, 6.0), 0.4);
  }
}

// Without noise all contacts agree, and the next one would differ by some per cent.
TEST(IdentifyToolFriction, IsNoMoreCertainThanFrictionRepeats) {
  const Push push = [](double t) { return slow_push(t, 0.8, 0.4); };
  const std::optional<ParameterValue> found = found_from({push, push}, 6.0);
  ASSERT_TRUE(found);
  EXPECT_GE(*found->std, 0.019 * found->value / std::sqrt(2.0));
}

TEST(IdentifyToolFriction, IsNotFoundFromATipThatSticks) {
  // The apparent slip, a tenth of the path, is an error of the tip's radius or of the tracking.
  const Push push = [](double t) { return slow_push(t, 0.1, 0.2); };
  EXPECT_FALSE(found_from({push, push, push}, 30.0));
}

TEST(IdentifyToolFriction, DoesNotCountThatATipRollsAlongATurningFace) {
  // About a corner 34 mm beside the tip, by 0.6 rad; its centre moves along the face by 12 mm.
  const Eigen::Vector3d corner(0.034, -0.05, 0.0);
  const Push push = [&corner](double t) {
    const double turn = -0.1 * t;
    const Eigen::Quaterniond R(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
    return PushState{Pose(R, corner - R * corner), -kRadius * turn, 0.2};
  };
  EXPECT_FALSE(found_from({push, push, push}, 6.0));
}

TEST(IdentifyToolFriction, DoesNotWeighWhatForceAPauseHas) {
  // Half a minute without motion, in which the friction is released.
  const Push push = [](double t) {
    if (t < 3.0) return slow_push(t, 0.8, 0.4);
    return t < 33.0 ? slow_push(3.0, 0.8, 0.1) : slow_push(t - 30.0, 0.8, 0.4);
  };
  expect_value(found_from({push, push}, 36.0), 0.4);
}

TEST(IdentifyToolFriction, IsNotFoundWhereItOpposesTheSlipInSomePushesOnly) {
  const Push opposing = [](double t) { return slow_push(t, 0.8, 0.4); };
  const Push driving = [](double t) { return slow_push(t, 0.8, -0.4); };
  EXPECT_FALSE(found_from({opposing, opposing, driving}, 6.0));
}

// The tip's path in the object's frame shows the turn: it is not along the mesh's face.
TEST(IdentifyToolFriction, DoubtsTheDirectionOfATurnedTrackedFrame) {
  constexpr double kFrameTurn = 0.1;  // [rad]
  const Push push = [](double t) { return slow_push(t, 0.8, 0.4); };
  const ObjectIdentification found = identified_from({push, push, push}, 6.0, kFrameTurn);
  const std::optional<ParameterValue>& friction = found.parameters.tool_friction_coefficient;
  ASSERT_TRUE(friction);
  EXPECT_GT(std::abs(friction->value - 0.4), 0.8 * kFrameTurn) << "or there is nothing to doubt";
  EXPECT_NEAR(friction->value, 0.4, 2.0 * *friction->std);
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].find("the tracked frame may be turned"), std::string::npos);
  EXPECT_TRUE(identified_from({push, push, push}, 6.0).notes.empty());
}

}  // namespace
}  // namespace pcavr
