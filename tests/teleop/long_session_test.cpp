// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <future>

#include <gtest/gtest.h>

#include "support/heap_counter.hpp"
#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/input_watch.hpp"

namespace pcavr {
namespace {

/// Largest number of allocations of one call in a long session: the start of a thread, and room for
/// samples. The analysis of a window makes thousands of allocations.
constexpr long kMaxAllocations = 50;

class LongSession : public testing::TestWithParam<bool> {};

/// The window is short, so that a session of half a minute is as long as three windows.
TEST_P(LongSession, NoCallAnalysesAWindow) {
  const PlantInput made = plant_input(3, true);
  TeleopOptions options;
  options.inputs.window = 5.0;
  InputWatch watch(made.input.objects, made.input.tool_radius, options,
                   Background{std::launch::async});
  const bool is_examined = GetParam();
  long most = 0;
  for (int i = 0; i < 30'000; ++i) {
    const double t = 1e-3 * i;
    const Eigen::Vector3d p_base_tip(0.1 * std::sin(t), 0.0, 0.5);
    const long before = heap_allocations_of_thread;
    watch.add_tool(t, p_base_tip, std::nullopt);
    watch.add_force(t, Eigen::Vector3d(0.0, 0.0, 0.01 * std::sin(40.0 * t)));
    if (is_examined && !watch.would_wait(t)) static_cast<void>(watch.examine(t, false));
    most = std::max(most, heap_allocations_of_thread - before);
  }
  EXPECT_LT(most, kMaxAllocations);
  EXPECT_FALSE(watch.findings().value().fault);
}

INSTANTIATE_TEST_SUITE_P(ExaminedOrNot, LongSession, testing::Bool());

}  // namespace
}  // namespace pcavr
