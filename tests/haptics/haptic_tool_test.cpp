// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_tool.hpp"

#include <gtest/gtest.h>

#include "haptics/closed_paths.hpp"
#include "haptics/scanned_bumps.hpp"

namespace pcavr {
namespace {

using test::kCycle;

TEST(HapticTool, IsPassiveOverClosedPaths) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  for (const double friction : {0.0, 0.5}) {
    for (const Compliance law : {Compliance{1000.0, 0.0, 1.0}, Compliance{3000.0, 2.0, 1.0},
                                 Compliance{40'000.0, 0.0, 1.5}}) {
      ForceOptions options;
      options.compliance = law;
      HapticTool tool(bumps.mesh(), {0.001, friction}, options);
      const test::Work work = test::over_closed_paths(tool, 200);
      EXPECT_GT(work.touched, 100);
      EXPECT_GE(work.min, -test::kRounding) << friction << ' ' << law.stiffness;
      EXPECT_GT(work.sum, 0.0);
    }
  }
}

}  // namespace
}  // namespace pcavr
