// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/input_watch.hpp"

#include <future>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

/// A push whose force has the wrong sign, passed to a watch in the order of arrival.
class WatchedPush {
 public:
  explicit WatchedPush(std::launch background)
      : watch(made_.input.objects, made_.input.tool_radius, {}, Background{background}) {}

  /// All samples from where it was up to `t` [s].
  void notify_change(double t) {
    const TeleopInput& input = made_.input;
    for (; tool_ < input.t_tool.size() && input.t_tool[tool_] <= t; ++tool_) {
      watch.add_tool(input.t_tool[tool_], input.p_base_tip[tool_], std::nullopt);
    }
    for (; force_ < input.t_force.size() && input.t_force[force_] <= t; ++force_) {
      watch.add_force(input.t_force[force_], input.force_base[force_]);
    }
  }
  [[nodiscard]] double end() const { return made_.input.t_tool.back(); }

 private:
  PlantInput made_ = plant_input(3, false, {.is_force_flipped = true});
  std::size_t tool_ = 0, force_ = 0;

 public:
  InputWatch watch;
};

class InputWatchInTheBackground : public testing::TestWithParam<std::launch> {};

TEST_P(InputWatchInTheBackground, AppliesWhatItFoundAtAFixedTimeOfTheData) {
  WatchedPush push(GetParam());
  push.notify_change(push.end());
  const double begin = push.end();
  EXPECT_FALSE(push.watch.examine(begin, true));
  EXPECT_FALSE(push.watch.examine(begin + 0.9 * InputWatch::kExaminationTime, true));
  EXPECT_FALSE(push.watch.fault());
  EXPECT_TRUE(push.watch.examine(begin + InputWatch::kExaminationTime, true));
  EXPECT_TRUE(push.watch.fault());
}

TEST_P(InputWatchInTheBackground, KeepsTheSamplesThatComeMeanwhile) {
  WatchedPush push(GetParam()), unexamined(std::launch::deferred);
  push.notify_change(0.5 * push.end());
  static_cast<void>(push.watch.examine(0.5 * push.end(), true));
  push.notify_change(push.end());
  unexamined.notify_change(push.end());
  const InputFindings found = push.watch.findings().value(),
                      all = unexamined.watch.findings().value();
  ASSERT_TRUE(found.fault && all.fault);
  EXPECT_EQ(found.fault->error.to_string(), all.fault->error.to_string());
  EXPECT_EQ(found.tool_to_force.offset, all.tool_to_force.offset);
  EXPECT_EQ(found.tool_to_force.std, all.tool_to_force.std);
}

INSTANTIATE_TEST_SUITE_P(OnAThreadOrNot, InputWatchInTheBackground,
                         testing::Values(std::launch::async, std::launch::deferred));

}  // namespace
}  // namespace pcavr
