// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_tool.hpp"

#include <gtest/gtest.h>

#include "haptics/closed_paths.hpp"
#include "haptics/scanned_bumps.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

using test::kCycle;

TEST(HapticTool, GivesNoMoreWorkThanItTookOverClosedPaths) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  for (const double friction : {0.0, 0.5}) {
    for (const Compliance law : {Compliance{1000.0, 0.0, 1.0}, Compliance{3000.0, 2.0, 1.0},
                                 Compliance{40'000.0, 0.0, 1.5}}) {
      ForceOptions options;
      options.compliance = law;
      HapticTool tool(bumps.mesh(), {0.001, friction}, options);
      const test::Work work = test::over_closed_paths(tool, 200);
      EXPECT_GT(work.touched, 100);
      EXPECT_GE(work.least, -test::kRounding) << friction << ' ' << law.stiffness;
      EXPECT_GT(work.sum, 0.0);
    }
  }
}

TEST(HapticTool, DoesTheSameAgainWithoutTheHeap) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  HapticTool first(bumps.mesh(), {}, {});
  HapticTool second(bumps.mesh(), {}, {});
  const test::PressAndSlide hand(4);
  ASSERT_TRUE(first.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  ASSERT_TRUE(second.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  const long before = heap_allocations;
  bool is_same = true;
  long contacts = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d tip = hand(1.85 + i * kCycle);
    const HapticState a = first.step(tip, kCycle);
    const HapticState b = second.step(tip, kCycle);
    is_same &= a.proxy == b.proxy && a.force == b.force;
    contacts += a.is_in_contact ? 1 : 0;
  }
  EXPECT_EQ(heap_allocations, before);
  EXPECT_TRUE(is_same);
  EXPECT_GT(contacts, 2000);
}

}  // namespace
}  // namespace pcavr
