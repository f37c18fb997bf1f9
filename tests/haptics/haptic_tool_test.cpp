// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/haptic_tool.hpp"

#include <gtest/gtest.h>

#include "haptics/closed_paths.hpp"
#include "haptics/scanned_bumps.hpp"

namespace pcavr {
namespace {

using test::kCycle;

TEST(HapticTool, IsPassiveOverClosedPaths) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  for (const double friction : {0.0, 0.5}) {
    for (const HuntCrossley law : {HuntCrossley{1000.0, 0.0, 1.0}, HuntCrossley{3000.0, 2.0, 1.0},
                                   HuntCrossley{40'000.0, 0.0, 1.5}}) {
      ForceOptions options;
      options.stiffness = law.stiffness;
      options.damping = law.damping;
      options.exponent = law.exponent;
      HapticTool tool(bumps.mesh(), test::proxy_options(0.001, friction), options);
      const test::Work work = test::over_closed_paths(tool, 200);
      EXPECT_GT(work.touched, 100);
      EXPECT_GE(work.min, -test::kRounding) << friction << ' ' << law.stiffness;
      EXPECT_GT(work.sum, 0.0);
    }
  }
}

}  // namespace
}  // namespace pcavr
