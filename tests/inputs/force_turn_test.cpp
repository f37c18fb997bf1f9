// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_turn.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(degrees * kDegree, axis.normalized()).toRotationMatrix();
}

/// A contact whose force must point along `expected_base`, and was recorded by a sensor that is
/// mounted turned by `sensor` in the tool's axes; its angle is off by `off` degrees in the plane.
ContactEvidence contact(const Eigen::Vector3d& expected_base, const Eigen::Quaterniond& q_base_tool,
                        const Eigen::Matrix3d& sensor, double off = 0.0) {
  const bool is_press = expected_base.z() < -0.5;
  const Eigen::Matrix3d R_base_tool = q_base_tool.toRotationMatrix();
  ContactEvidence evidence;
  const Eigen::Vector3d force_base = about(Eigen::Vector3d::UnitZ(), off) * expected_base;
  evidence.direction =
      ForceDirection{.force_base = R_base_tool * sensor * R_base_tool.transpose() * force_base,
                     .expected_base = expected_base,
                     .across_std = (is_press ? 6.0 : 4.0) * kDegree,
                     .upward_std = 6.0 * kDegree,
                     .q_base_tool = q_base_tool};
  return evidence;
}

const Eigen::Quaterniond kToolDown(0.0, 1.0, 0.0, 0.0);

/// Two presses, pushes along y and back, and one along x, with the scatter of real friction.
std::vector<ContactEvidence> contacts(const Eigen::Matrix3d& sensor, bool turns_tool = false) {
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  std::vector<ContactEvidence> all;
  int i = 0;
  for (const Eigen::Vector3d& expected :
       {down, down, Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0),
        Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0)}) {
    const double off = i % 2 == 0 ? 3.0 : -3.0;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5 * i, Eigen::Vector3d::UnitZ()));
    all.push_back(contact(expected, turns_tool ? turn * kToolDown : kToolDown, sensor, off));
    ++i;
  }
  return all;
}

std::string error_of(const std::vector<ContactEvidence>& evidence) {
  const TurnFinding found = state_force_turn(evidence);
  return found.error ? found.error->to_string() : "";
}

TEST(ForceTurn, IsNotFoundInSoundContacts) {
  EXPECT_EQ(error_of(contacts(Eigen::Matrix3d::Identity())), "");
  EXPECT_EQ(state_force_turn(contacts(Eigen::Matrix3d::Identity())).note, "");
  EXPECT_EQ(error_of({}), "");
}

TEST(ForceTurn, OfASensorAboutTheToolIsNamedWithItsAngle) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  for (const double degrees : {15.0, 30.0, -45.0, 60.0, 120.0}) {
    for (const bool turns_tool : {false, true}) {
      const std::string error = error_of(contacts(about(z, degrees), turns_tool));
      EXPECT_NE(error.find("about the tool's z axis"), std::string::npos) << error;
      const std::size_t by = error.find("turned by ");
      ASSERT_NE(by, std::string::npos) << degrees << error;
      EXPECT_NEAR(std::stod(error.substr(by + 10)), degrees, 2.0) << error;
    }
  }
}

TEST(ForceTurn, OfATiltedSensorIsNamed) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
    const std::string error = error_of(contacts(about(axis, 20.0)));
    EXPECT_NE(error.find(axis.x() > 0.5 ? "the tool's x axis" : "the tool's y axis"),
              std::string::npos)
        << error;
    EXPECT_NE(state_force_turn(contacts(about(axis, 14.0))).note, "");
  }
}

TEST(ForceTurn, NamesMirroredAndPermutedAxes) {
  Eigen::Matrix3d mirrored = Eigen::Matrix3d::Identity();
  mirrored(1, 1) = -1.0;
  EXPECT_NE(error_of(contacts(mirrored)).find("read as, for example, (fx, -fy, fz)"),
            std::string::npos)
      << error_of(contacts(mirrored));
  const std::string swapped = error_of(contacts(about(Eigen::Vector3d::UnitZ(), 90.0)));
  EXPECT_NE(swapped.find("other axes"), std::string::npos) << swapped;
}

TEST(ForceTurn, OfTheToolItselfIsCalledItsAxes) {
  const Eigen::Quaterniond tilted(about(Eigen::Vector3d(1, 2, 0), 25.0));
  std::vector<ContactEvidence> evidence = contacts(Eigen::Matrix3d::Identity());
  for (ContactEvidence& one : evidence) {
    one.direction->q_base_tool = tilted;
    one.direction->force_base = tilted.conjugate() * one.direction->force_base;
  }
  EXPECT_NE(error_of(evidence).find("in the tool's axes"), std::string::npos) << error_of(evidence);
}

/// Friction at the tip turns the force of each push, on either side; one push is no proof.
TEST(ForceTurn, IsNotFriction) {
  std::vector<ContactEvidence> evidence;
  for (const double off : {20.0, -18.0, 14.0, -22.0, 9.0, -3.0}) {
    evidence.push_back(
        contact(Eigen::Vector3d(0, 1, 0), kToolDown, Eigen::Matrix3d::Identity(), off));
  }
  EXPECT_EQ(error_of(evidence), "");
  EXPECT_EQ(
      error_of({contact(Eigen::Vector3d(0, 1, 0), kToolDown, Eigen::Matrix3d::Identity(), 30.0)}),
      "");
}

TEST(ForceTurn, IsFoundBesideAPushWithoutTracking) {
  std::vector<ContactEvidence> evidence = contacts(about(Eigen::Vector3d::UnitZ(), 30.0));
  evidence[3].direction->expected_base = Eigen::Vector3d(-0.6, -0.8, 0.0);
  EXPECT_NE(error_of(evidence).find("about the tool's z axis"), std::string::npos)
      << error_of(evidence);
}

}  // namespace
}  // namespace pcavr
