// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/transform_tree.hpp"

#include <chrono>

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

TEST(TransformTree, AStaticLinkHoldsUntilItIsReplaced) {
  TransformTree tree;
  tree.add_static("base", "tip", seconds(2.5), at_x(0.12));  // out of order
  tree.add_static("base", "tip", seconds(1.0), at_x(0.15));
  tree.add_static("base", "tip", seconds(2.0), at_x(0.15));  // repeated
  tree.add_static("base", "still", seconds(1.0), at_x(1.0));
  tree.add_static("base", "still", seconds(3.0), at_x(1.0));
  tree.finish();
  const auto chain = tree.chain("base", "tip");
  ASSERT_TRUE(chain);
  const auto x_at = [&](double t) { return tree.lookup(*chain, seconds(t))->translation().x(); };
  EXPECT_EQ(x_at(-50.0), 0.15);
  EXPECT_EQ(x_at(2.499), 0.15);
  EXPECT_EQ(x_at(2.5), 0.12);
  EXPECT_EQ(x_at(900.0), 0.12);
  EXPECT_TRUE(tree.stamps(*chain).empty());
  EXPECT_EQ(chain_text("base", *chain), "base -> tip (fixed)");
  ASSERT_EQ(tree.replaced().size(), 1U);
  EXPECT_EQ(tree.replaced().at("tip").size(), 2U);
  EXPECT_EQ(tree.replaced().at("tip")[1].since, seconds(2.5));
}

/// The arm moves tool0; the tip was below a flange that another tree has, and then below tool0.
TEST(TransformTree, AStaticLinkMayGetAnotherParent) {
  TransformTree tree;
  tree.add_static("flange", "tip", seconds(1.0), at_x(0.3));
  tree.add_static("base", "flange", seconds(1.0), at_x(7.0));
  tree.add_static("tool0", "tip", seconds(2.0), at_x(0.1));
  for (int i = 0; i <= 30; ++i) tree.add("base", "tool0", seconds(0.1 * i), at_x(0.1 * i));
  tree.finish();
  const auto chain = tree.chain("base", "tip");
  ASSERT_TRUE(chain);
  EXPECT_EQ(chain_text("base", *chain), "base -> tool0 -> tip (fixed)");
  EXPECT_NEAR(tree.lookup(*chain, seconds(1.5))->translation().x(), 7.3, 1e-12);
  EXPECT_NEAR(tree.lookup(*chain, seconds(2.5))->translation().x(), 2.6, 1e-12);
  EXPECT_EQ(tree.stamps(*chain).size(), 31U);
  EXPECT_TRUE(tree.reparented().empty());
  // The way back is the same.
  const auto back = tree.chain("tip", "base");
  ASSERT_TRUE(back);
  EXPECT_NEAR(tree.lookup(*back, seconds(1.5))->translation().x(), -7.3, 1e-12);
}

/// The moving link is first connected by the other parent: its stamps count too.
TEST(TransformTree, StampsAreThoseOfEveryChain) {
  TransformTree tree;
  tree.add_static("left", "tip", seconds(0.0), at_x(0.0));
  tree.add_static("right", "tip", seconds(1.0), at_x(0.0));
  for (int i = 0; i <= 10; ++i) {
    tree.add("base", "left", seconds(0.1 * i), at_x(0.1 * i));
    tree.add("base", "right", seconds(1.0 + 0.1 * i), at_x(0.1 * i));
  }
  tree.finish();
  EXPECT_EQ(tree.stamps(*tree.chain("base", "tip")).size(), 21U);
}

TEST(TransformTree, OfALinkThatMovesAStaticValueIsOneSample) {
  TransformTree tree;
  tree.add_static("base", "arm", seconds(1.1), at_x(1.1));
  tree.add("base", "arm", seconds(1.0), at_x(1.0));
  tree.add("base", "arm", seconds(1.2), at_x(1.2));
  tree.finish();
  const auto chain = tree.chain("base", "arm");
  EXPECT_NEAR(tree.lookup(*chain, seconds(1.15))->translation().x(), 1.15, 1e-12);
  EXPECT_FALSE(tree.lookup(*chain, seconds(5.0)));
  EXPECT_TRUE(tree.replaced().empty());
}

TEST(TransformTree, OfALiveSourceTheNewestStaticLinkHolds) {
  TransformTree tree(std::chrono::seconds(10));
  tree.add_static("base", "tip", seconds(5.0), at_x(0.1));
  tree.add_static("base", "tip", seconds(5.0), at_x(0.2));
  tree.add_static("other", "tip", seconds(4.0), at_x(0.3));
  EXPECT_FALSE(tree.chain("base", "tip"));
  const auto chain = tree.chain("other", "tip");
  ASSERT_TRUE(chain);
  EXPECT_EQ(tree.lookup(*chain, seconds(100.0))->translation().x(), 0.3);
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
