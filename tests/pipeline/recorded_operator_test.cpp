// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/sites/operator_interface.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {
namespace {

/// 1 s of motion along x from (0.5, 0, 0.1) m.
TeleopInput motion() {
  TeleopInput world;
  for (int i = 0; i <= 500; ++i) {
    world.t_tool.push_back(0.002 * i);
    world.p_base_tip.emplace_back(0.5 + 2e-4 * i, 0.0, 0.1);
  }
  return world;
}

TEST(RecordedOperator, LeadsARobotThatFollowsToItsBegin) {
  const TeleopInput world = motion();
  const TeleopOptions options;
  auto person = make_recorded_operator(world, options);
  ASSERT_TRUE(person) << person.error().to_string();
  const std::size_t recorded = *(*person)->cycles();
  LinkState robot;
  robot.p_base_tip = {0.3F, 0.0F, 0.1F};
  const std::size_t first = 301;  // the link took until then
  EXPECT_LT(((*person)->p_base_start(first, &robot) - Eigen::Vector3d(0.3, 0.0, 0.1)).norm(), 1e-6);
  const std::size_t total = *(*person)->cycles();
  EXPECT_NEAR(static_cast<double>(total - recorded - first + 1) * options.predictor.step, 2.3,
              0.01);
  const auto x_at = [&](std::size_t cycle) {
    return (*person)->p_base_start(cycle + 1, &robot).x();
  };
  double fastest = 0.0;
  for (std::size_t i = first; i + 1 < total - recorded; ++i) {
    fastest = std::max(fastest, (x_at(i + 1) - x_at(i)) / options.predictor.step);
  }
  EXPECT_LT(fastest, 0.2);
  EXPECT_NEAR(x_at(total - recorded - 1), 0.5, 1e-3);
  EXPECT_NEAR(x_at(total), 0.6, 1e-3);
}

TEST(RecordedOperator, ShowsTheMotionAtItsTimesToARobotThatDoesNot) {
  const TeleopInput world = motion();
  auto person = make_recorded_operator(world, {});
  ASSERT_TRUE(person) << person.error().to_string();
  const std::size_t recorded = *(*person)->cycles();
  EXPECT_NEAR((*person)->p_base_start(501, nullptr).x(), 0.55, 1e-3);
  EXPECT_EQ(*(*person)->cycles(), recorded);
}

}  // namespace
}  // namespace pcavr
