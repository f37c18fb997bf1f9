// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/tool_retraction.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kRetractionStep = 0.001;  // [s]
constexpr double kRetractionSpeed = 0.05;  // [m/s]
const Eigen::Vector3d kOut(0.0, -1.0, 0.0);

TEST(ToolRetraction, MovesByTheDisplacementAndOnUntilTheObjectIsNotTouched) {
  ToolRetraction retraction(kRetractionSpeed);
  const Eigen::Vector3d command(0.4, 0.0, 0.1);
  retraction.step(command, false, kRetractionStep);
  retraction.begin(2, 0.001 * kOut);
  ASSERT_EQ(retraction.object(), 2U);
  Eigen::Vector3d before = retraction.offset();
  for (int k = 0; k < 60; ++k) {  // touched until it has moved by 3 mm
    retraction.step(command, retraction.offset().norm() < 0.003, kRetractionStep);
    EXPECT_LE((retraction.offset() - before).norm(), kRetractionSpeed * kRetractionStep + 1e-12);
    before = retraction.offset();
  }
  EXPECT_NEAR((retraction.offset() - 0.003 * kOut).norm(), 0.0,
              1.01 * kRetractionSpeed * kRetractionStep);
  for (int k = 0; k < 100; ++k) retraction.step(command, false, kRetractionStep);
  EXPECT_FALSE(retraction.object());
  EXPECT_EQ(retraction.offset(), before);
}

TEST(ToolRetraction, IsUsedUpAsTheOperatorMovesBackAndNotAsItAdvances) {
  ToolRetraction retraction(kRetractionSpeed);
  Eigen::Vector3d command(0.4, 0.0, 0.1);
  retraction.step(command, false, kRetractionStep);
  retraction.begin(0, 0.002 * kOut);
  for (int k = 0; k < 100; ++k) retraction.step(command, false, kRetractionStep);
  const Eigen::Vector3d full = retraction.offset();
  EXPECT_NEAR(full.norm(), 0.002, 1.01 * kRetractionSpeed * kRetractionStep);
  command -= 0.004 * kOut;
  retraction.step(command, false, kRetractionStep);
  EXPECT_EQ(retraction.offset(), full);
  command += 0.0005 * kOut;
  retraction.step(command, false, kRetractionStep);
  EXPECT_NEAR(retraction.offset().norm(), full.norm() - 0.0005, 1e-12);
  command += 0.01 * kOut;
  retraction.step(command, false, kRetractionStep);
  EXPECT_EQ(retraction.offset().norm(), 0.0);
}

TEST(ToolRetraction, KeepsTheToolOffUntilTheRelease) {
  ToolRetraction retraction(kRetractionSpeed);
  Eigen::Vector3d command(0.4, 0.0, 0.1);
  retraction.step(command, false, kRetractionStep);
  retraction.keep_off(1, 0.002 * kOut);
  const auto advance = [&] {
    command -= 3e-5 * kOut;  // 30 mm/s into the object
    retraction.step(command, false, kRetractionStep);
    return command + retraction.offset();
  };
  for (int k = 0; k < 60; ++k) static_cast<void>(advance());
  const Eigen::Vector3d off = advance();
  EXPECT_NEAR((off - Eigen::Vector3d(0.4, 0.0, 0.1)).dot(kOut), 0.002, 1e-4);
  for (int k = 0; k < 500; ++k) EXPECT_TRUE((advance() - off).isZero(1e-9));
  EXPECT_EQ(retraction.object(), 1U);
  retraction.release();
  static_cast<void>(advance());
  EXPECT_FALSE(retraction.object());
  const Eigen::Vector3d released = advance();
  EXPECT_NEAR((advance() - released).norm(), 3e-5, 1e-9);
}

TEST(ToolRetraction, EndsWhereTheToolStaysInContact) {
  ToolRetraction retraction(kRetractionSpeed);
  const Eigen::Vector3d command(0.4, 0.0, 0.1);
  retraction.begin(0, 0.001 * kOut);
  for (int k = 0; k < 1000; ++k) retraction.step(command, true, kRetractionStep);
  EXPECT_FALSE(retraction.object());
  EXPECT_LE(retraction.offset().norm(), 0.021);
}

TEST(ToolRetraction, DoesNothingWithoutSpeedOrDisplacement) {
  ToolRetraction none(0.0);
  none.begin(0, 0.001 * kOut);
  EXPECT_FALSE(none.object());
  ToolRetraction retraction(kRetractionSpeed);
  retraction.begin(0, Eigen::Vector3d::Zero());
  EXPECT_FALSE(retraction.object());
}

}  // namespace
}  // namespace pcavr
