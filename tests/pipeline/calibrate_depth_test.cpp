// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Scale and offset of depth, from views whose truth is known.
#include "pcavr/pipeline/calibrate_depth.hpp"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Three tags from 20 places, ten images at each; a place's error is common to its images.
struct DepthRig {
  double scale = 1.015, offset = 0.008;
  double nearest = 0.6, farthest = 1.6;
  double place_std = 0.002;  ///< [m] of all tags of one place
  int places = 20;

  [[nodiscard]] DepthViews views(std::uint64_t seed) const {
    Random random(seed);
    DepthViews made{.depth_scale = 1000.0};
    for (int place = 0; place < places; ++place) {
      const double common = place_std * random.normal();
      const double distance = random.uniform(nearest, farthest);
      for (int tag = 0; tag < 3; ++tag) {
        const double own = place_std * random.normal();
        const double z = distance * (1.0 + 0.02 * tag);
        for (int image = 0; image < 10; ++image) {
          const double noise = common + own + 2e-4 * random.normal();
          made.views.push_back({.tag = "tag36h11:" + std::to_string(tag),
                                .place = static_cast<std::size_t>(place),
                                .by_depth = (z + noise - offset) / scale,
                                .by_tags = z});
        }
      }
    }
    made.places = static_cast<std::size_t>(places);
    made.frames = made.views.size() / 3;
    return made;
  }
};

TEST(CalibrateDepth, FindsScaleAndOffsetWithStdsThatHold) {
  constexpr int kRigs = 200;
  const DepthRig rig;
  int within = 0;
  double largest = 0.0;
  for (std::uint64_t seed = 1; seed <= kRigs; ++seed) {
    const auto found = calibrate_depth(rig.views(seed));
    ASSERT_TRUE(found) << found.error().to_string();
    ASSERT_TRUE(found->has_offset);
    for (const double off : {(found->scale - rig.scale) / found->scale_std,
                             (found->offset - rig.offset) / found->offset_std}) {
      within += std::abs(off) < 1.0 ? 1 : 0;
      largest = std::max(largest, std::abs(off));
    }
  }
  const double share = within / (2.0 * kRigs);
  std::printf("  within one std: %.1f %%, largest %.1f stds\n", 100.0 * share, largest);
  EXPECT_NEAR(share, 0.68, 0.08);
  EXPECT_LT(largest, 5.0);
}

TEST(CalibrateDepth, GivesWhatTheCameraTakesAndTheErrorOfUnseenPlaces) {
  const DepthRig rig;
  const auto found = calibrate_depth(rig.views(3));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->depth_scale, 1000.0 / rig.scale, 5.0);
  EXPECT_NEAR(found->depth_offset, rig.offset, 5e-3);
  EXPECT_NEAR(found->held_out_rms, std::sqrt(2.0) * rig.place_std, 1e-3);
  EXPECT_GT(found->before_rms, 0.015);
  EXPECT_TRUE(found->notes.empty()) << found->notes.front();
}

TEST(CalibrateDepth, SaysThatOneDistanceShowsNoOffset) {
  const DepthRig rig{.scale = 1.02, .offset = 0.0, .nearest = 0.95, .farthest = 1.0};
  const auto found = calibrate_depth(rig.views(1));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->has_offset);
  EXPECT_EQ(found->offset, 0.0);
  EXPECT_NEAR(found->scale, 1.02, 3e-3);
  ASSERT_EQ(found->notes.size(), 1U);
  EXPECT_NE(found->notes[0].find("not observable"), std::string::npos);
  EXPECT_NE(format_depth(*found, {.recording = "r"}).find("offset: ~"), std::string::npos);
}

TEST(CalibrateDepth, NamesATagOfAnotherSize) {
  DepthViews views = DepthRig{.scale = 1.0, .offset = 0.0}.views(2);
  for (DepthView& view : views.views) {
    if (view.tag == "tag36h11:1") view.by_tags *= 0.95;
  }
  const auto found = calibrate_depth(views);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->notes.size(), 1U);
  EXPECT_NE(found->notes[0].find("tag36h11:1 is"), std::string::npos) << found->notes[0];
  EXPECT_NE(found->notes[0].find("check its size"), std::string::npos);
}

TEST(CalibrateDepth, NeedsSeveralPlaces) {
  const auto found = calibrate_depth(DepthRig{.places = 3}.views(1));
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("from 3 places"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
