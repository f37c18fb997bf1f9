// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/stage_clock.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(StageClock, SumsByStageInTheOrderOfTheirFirstBeginning) {
  StageClock clock;
  clock.begin("track");
  clock.begin("fuse");
  clock.begin("track");
  clock.end();
  clock.end();
  ASSERT_EQ(clock.times().size(), 2u);
  EXPECT_EQ(clock.times()[0].stage, "track");
  EXPECT_EQ(clock.times()[1].stage, "fuse");
  EXPECT_GT(clock.times()[0].wall_seconds, 0.0);
}

}  // namespace
}  // namespace pcavr
