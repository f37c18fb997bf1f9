// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_layout.hpp"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "marker/layout_coverage.hpp"
#include "marker/random_layout.hpp"

namespace pcavr {
namespace {

using test::a_camera;
using test::RandomLayout;

TEST(SolveTagLayout, RecoversALayoutOfWhichOneTagIsGiven) {
  const RandomLayout rig(3, {.tags = 5, .corner_std = 0.0});
  const auto found = solve_tag_layout(rig.with_stated(1), rig.frames, a_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  ASSERT_EQ(found->tags.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_LT(translation_distance(found->tags[i].T_body_tag, *rig.tags[i].T_body_tag), 1e-6) << i;
    EXPECT_LT(rotation_distance(found->tags[i].T_body_tag, *rig.tags[i].T_body_tag), 1e-6) << i;
  }
  EXPECT_TRUE(found->tags[0].is_reference);
  EXPECT_FALSE(found->tags[1].is_reference);
}

TEST(SolveTagLayout, NamesTheOneTagThatIsNotWhereItIsSaidToBe) {
  const RandomLayout rig(4, {.tags = 4});
  std::vector<LayoutTag> stated = rig.tags;
  stated[2].T_body_tag = Pose::from_translation({0.04, -0.042, 0.0}) * *stated[2].T_body_tag;
  const auto found = solve_tag_layout(stated, rig.frames, a_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(found->tags[i].shift->has_moved, i == 2) << i;
    EXPECT_EQ(found->tags[i].is_reference, i != 2) << i;
    EXPECT_LT(translation_distance(found->tags[i].T_body_tag, *rig.tags[i].T_body_tag), 2e-3) << i;
  }
  EXPECT_NEAR(found->tags[2].shift->offset, 0.058, 0.002);
}

TEST(SolveTagLayout, AsksWhichOfTwoTagsIsRight) {
  const RandomLayout rig(5, {.tags = 2});
  std::vector<LayoutTag> stated = rig.tags;
  stated[1].T_body_tag = Pose::from_translation({0.058, 0.0, 0.0}) * *stated[1].T_body_tag;
  const auto refused = solve_tag_layout(stated, rig.frames, a_camera());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("tag36h11:0, tag36h11:1 disagree"), std::string::npos)
      << refused.error().to_string();
  EXPECT_NE(refused.error().hint.find("--fixed"), std::string::npos);
  stated[0].is_fixed = true;
  const auto found = solve_tag_layout(stated, rig.frames, a_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_LT(translation_distance(found->tags[1].T_body_tag, *rig.tags[1].T_body_tag), 2e-3);
  EXPECT_TRUE(found->tags[1].shift->has_moved);
}

TEST(SolveTagLayout, FindsATagThatIsMovedDuringTheWalk) {
  const Pose T_world_tag = *RandomLayout(6, {.tags = 4, .views = 0}).tags[3].T_body_tag;
  const Pose T_moved = Pose::from_translation({0.02, 0.01, 0.0}) * T_world_tag;
  const RandomLayout rig(
      6, {.tags = 4, .views = 40, .T_world_moved = {T_moved}, .moved_tag = 3, .moved_from = 22});
  const auto found = solve_tag_layout(rig.with_stated(3), rig.frames, a_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(found->tags[i].move.has_value(), i == 3) << i;
  ASSERT_TRUE(found->tags[3].move);
  EXPECT_LT(found->tags[3].move->last_before, 22U);
  EXPECT_GE(found->tags[3].move->first_after, 22U);
  EXPECT_NEAR(found->tags[3].move->offset, std::hypot(0.02, 0.01), 2e-3);
  EXPECT_LT(translation_distance(found->tags[3].T_body_tag, T_moved), 2e-3);
}

TEST(SolveTagLayout, LeavesOutWhatIsMisreadAndWhatIsNotLinked) {
  RandomLayout rig(7, {.tags = 4});
  for (std::size_t i = 0; i < rig.frames.size(); i += 5) {
    for (Eigen::Vector2d& corner : rig.frames[i].front().corners) corner.x() += 25.0;
  }
  std::vector<LayoutTag> tags = rig.with_stated(1);
  tags.push_back({.id = {"tag36h11", 77}, .size = 0.1});
  const auto found = solve_tag_layout(tags, rig.frames, a_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  ASSERT_EQ(found->unlinked.size(), 1U);
  EXPECT_EQ(found->unlinked[0].id, 77);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(translation_distance(found->tags[i].T_body_tag, *rig.tags[i].T_body_tag), 3e-3) << i;
  }
}

TEST(SolveTagLayout, NeedsImagesOfTwoTags) {
  RandomLayout rig(8, {.tags = 2});
  for (auto& frame : rig.frames) frame.resize(std::min<std::size_t>(frame.size(), 1));
  EXPECT_FALSE(solve_tag_layout(rig.with_stated(1), rig.frames, a_camera()));
}

TEST(SolveTagLayout, StatesStdsThatHoldOnRandomLayouts) {
  const test::LayoutCoverage coverage = test::layout_coverage(1, 30);
  std::printf("  within one std: %.1f %%, largest error %.2f std\n", coverage.percent,
              coverage.largest);
  EXPECT_NEAR(coverage.percent, 68.0, 8.0);
  EXPECT_LT(coverage.largest, 5.0);
}

}  // namespace
}  // namespace pcavr
