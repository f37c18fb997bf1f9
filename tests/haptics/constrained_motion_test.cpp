// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/constrained_motion.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace pcavr::detail {
namespace {

const Eigen::Vector3d kOrigin = Eigen::Vector3d::Zero();

TEST(ConstrainedMotion, ReachesTheGoalWithoutConstraints) {
  double budget = 2.0;
  const Eigen::Vector3d goal(1.0, 0.5, -0.25);
  EXPECT_EQ(move_constrained(kOrigin, goal, {}, budget), goal);
  EXPECT_NEAR(budget, 2.0 - goal.norm(), 1e-15);
}

TEST(ConstrainedMotion, SlidesAlongAPlaneThatItMeets) {
  std::vector<HalfSpace> floor{{Eigen::Vector3d::UnitZ(), 0.5}};
  double budget = 10.0;
  const Eigen::Vector3d end = move_constrained(kOrigin, {2.0, 0.0, -1.0}, floor, budget);
  EXPECT_NEAR((end - Eigen::Vector3d(2.0, 0.0, -0.5)).norm(), 0.0, 1e-12);
  EXPECT_EQ(floor[0].slack, 0.0);
}

TEST(ConstrainedMotion, FollowsTheCreaseOfTwoPlanesAndStopsInACorner) {
  std::vector<HalfSpace> corner{{Eigen::Vector3d::UnitZ(), 0.1},
                                {Eigen::Vector3d::UnitY(), 0.2},
                                {-Eigen::Vector3d::UnitX(), 0.7}};
  double budget = 10.0;
  const Eigen::Vector3d end = move_constrained(kOrigin, {1.0, -1.0, -1.0}, corner, budget);
  EXPECT_NEAR((end - Eigen::Vector3d(0.7, -0.2, -0.1)).norm(), 0.0, 1e-12);
}

TEST(ConstrainedMotion, MovesNoFartherThanTheBudget) {
  std::vector<HalfSpace> floor{{Eigen::Vector3d::UnitZ(), 0.0}};
  double budget = 0.25;
  const Eigen::Vector3d end = move_constrained(kOrigin, {3.0, 0.0, -4.0}, floor, budget);
  EXPECT_NEAR((end - Eigen::Vector3d(0.25, 0.0, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(budget, 0.0);
}

// More planes than are active, two of them nearly parallel.
TEST(ConstrainedMotion, ProjectsTheDesiredDirectionOnTheCone) {
  const std::vector<HalfSpace> planes{{Eigen::Vector3d::UnitZ(), 0.0},
                                      {Eigen::Vector3d(1e-7, 0.0, 1.0).normalized(), 0.0},
                                      {Eigen::Vector3d(1.0, 0.0, 1.0).normalized(), 0.0},
                                      {Eigen::Vector3d::UnitX(), 1.0}};
  EXPECT_NEAR((project_on_cone({1.0, 2.0, -1.0}, planes) - Eigen::Vector3d(1.0, 2.0, 0.0)).norm(),
              0.0, 1e-6);
  EXPECT_NEAR((project_on_cone({-1.0, 2.0, -1.0}, planes) - Eigen::Vector3d(0.0, 2.0, 0.0)).norm(),
              0.0, 1e-6);
  EXPECT_EQ(project_on_cone({1.0, 2.0, 3.0}, planes), Eigen::Vector3d(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace pcavr::detail
