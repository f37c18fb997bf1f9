// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/trajectory.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

using std::chrono::milliseconds;

Stamp at(int ms) { return {ms * 1'000'000LL}; }

/// Moves along x at 1 m/s: poses at 0, 100 and 500 ms.
Trajectory along_x() {
  Trajectory trajectory;
  for (const int ms : {0, 100, 500}) {
    trajectory.append(at(ms), Pose::from_translation({ms * 1e-3, 0, 0}));
  }
  return trajectory;
}

TEST(Trajectory, InterpolatesBetweenItsPoses) {
  EXPECT_NEAR(along_x().at(at(30))->translation().x(), 0.03, 1e-15);
  EXPECT_EQ(along_x().at(at(100))->translation().x(), 0.1);
  EXPECT_EQ(along_x().at(at(500))->translation().x(), 0.5);
}

TEST(Trajectory, HasNoPoseBeyondItsEndsNorInGaps) {
  EXPECT_FALSE(along_x().at(at(-1)));
  EXPECT_FALSE(along_x().at(at(501)));
  EXPECT_FALSE(along_x().at(at(300)));
  EXPECT_TRUE(along_x().at(at(300), milliseconds(400)));
  EXPECT_FALSE(Trajectory().at(at(0)));
}

TEST(Trajectory, FindsTheNearestWithinATolerance) {
  EXPECT_EQ(along_x().nearest(at(60), milliseconds(50)), 1u);
  EXPECT_EQ(along_x().nearest(at(50), milliseconds(50)), 0u) << "a tie gives the earlier pose";
  EXPECT_EQ(along_x().nearest(at(550), milliseconds(50)), 2u);
  EXPECT_FALSE(along_x().nearest(at(551), milliseconds(50)));
  EXPECT_FALSE(along_x().nearest(at(-51), milliseconds(50)));
  EXPECT_FALSE(Trajectory().nearest(at(0), milliseconds(50)));
}

TEST(Trajectory, RejectsStampsThatDoNotIncrease) {
  Trajectory trajectory = along_x();
  EXPECT_THROW(trajectory.append(at(500), Pose()), ContractError);
  EXPECT_THROW(Trajectory({{at(1), Pose()}, {at(1), Pose()}}), ContractError);
}

}  // namespace
}  // namespace pcavr
