// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/rosbag/transform_tree.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

Pose at_x(double x) { return Pose::from_translation({x, 0.0, 0.0}); }

Stamp seconds(double t) { return Stamp::from_seconds(t); }

TEST(TransformTree, InterpolatesLinksThatMove) {
  TransformTree tree;
  tree.add("base", "slide", seconds(1.2), at_x(2.0));
  tree.add("base", "slide", seconds(1.0), at_x(1.0));  // out of order
  tree.finish();
  const auto chain = tree.chain("base", "slide");
  ASSERT_TRUE(chain);
  EXPECT_NEAR(tree.lookup(*chain, seconds(1.05))->translation().x(), 1.25, 1e-12);
  EXPECT_FALSE(tree.lookup(*chain, seconds(0.9)));
  EXPECT_EQ(tree.stamps(*chain).size(), 2U);
}

TEST(TransformTree, LinksThatDoNotMoveHoldAtAllTimes) {
  TransformTree tree;
  for (const double future : {5.5, 5.6, 5.7}) tree.add("base", "ft", seconds(future), at_x(0.1));
  tree.finish();
  const auto chain = tree.chain("ft", "base");
  ASSERT_TRUE(chain);
  EXPECT_NEAR(tree.lookup(*chain, seconds(1.0))->translation().x(), -0.1, 1e-12);
  EXPECT_EQ(chain_text("ft", *chain), "ft -> base (fixed)");
  EXPECT_TRUE(tree.stamps(*chain).empty());
}

TEST(TransformTree, ALongRestIsKnownThroughout) {
  TransformTree tree;
  for (int i = 0; i <= 100; ++i) tree.add("base", "arm", seconds(0.1 * i), at_x(1.0));
  tree.add("base", "arm", seconds(10.1), at_x(2.0));
  tree.finish();
  const auto chain = tree.chain("base", "arm");
  for (const double t : {0.05, 3.33, 7.77, 10.0}) {
    ASSERT_TRUE(tree.lookup(*chain, seconds(t))) << t;
    EXPECT_NEAR(tree.lookup(*chain, seconds(t))->translation().x(), 1.0, 1e-12) << t;
  }
}

TEST(TransformTree, GoesUpAndDownAndStopsAtLoops) {
  TransformTree tree;
  tree.add("root", "left", seconds(0.0), at_x(1.0));
  tree.add("root", "right", seconds(0.0), at_x(5.0));
  tree.add("a", "b", seconds(0.0), Pose());
  tree.add("b", "a", seconds(0.0), Pose());
  tree.add("other", "left", seconds(0.0), Pose());
  tree.finish();
  const auto chain = tree.chain("left", "right");
  ASSERT_TRUE(chain);
  EXPECT_NEAR(tree.lookup(*chain, seconds(9.0))->translation().x(), 4.0, 1e-12);
  EXPECT_FALSE(tree.chain("root", "a"));
  EXPECT_EQ(tree.reparented(), std::vector<std::string>{"left"});
}

}  // namespace
}  // namespace pcavr
