// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/view_selection.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// Stripes of a contrast: sharper with more.
ColorImage striped(int contrast) {
  ColorImage image(32, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const auto value = static_cast<std::uint8_t>(100 + (x % 2) * contrast);
      image(x, y) = {value, value, value};
    }
  }
  return image;
}

Stamp at_seconds(double seconds) { return Stamp::from_seconds(seconds); }

TEST(ViewSelection, KeepsTheSharpestOfNearbyViews) {
  ViewSelection selection;
  for (std::size_t i = 0; i < 5; ++i) {
    selection.add(i, at_seconds(0.02 * static_cast<double>(i)), Pose(), striped(i == 3 ? 90 : 20),
                  DepthImage(32, 32, static_cast<float>(i)), {});
  }
  const std::vector<ViewCandidate> chosen = selection.take_chosen(1);
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen.front().frame, 3U);
}

/// A path with views far apart from each other.
ViewSelection selection_along_path(const TextureOptions& options, std::size_t views) {
  ViewSelection selection(options);
  for (std::size_t i = 0; i < views; ++i) {
    const auto x = 0.1 * static_cast<double>(i);
    selection.add(i, at_seconds(x), Pose::from_translation({x, 0, 0}), striped(50),
                  DepthImage(32, 32, static_cast<float>(i)), {});
  }
  return selection;
}

TEST(ViewSelection, BoundsNumberAndMemory) {
  TextureOptions options;
  options.max_views = 10;
  options.max_view_memory = 16;
  const ViewSelection selection = selection_along_path(options, 1000);
  EXPECT_GE(ViewSelection(selection).take_chosen(1).size(), 5U);
  EXPECT_LE(ViewSelection(selection).take_chosen(1).size(), 10U);
  EXPECT_EQ(ViewSelection(selection).take_chosen(8U << 20U).size(), 2U);  // 8 MiB each
}

TEST(ViewSelection, KeepsTheImagesThatFitIntoMemory) {
  TextureOptions options;
  options.max_views = 1000;
  options.max_view_memory = 1;
  constexpr std::size_t kImages = 32 * 32 * (sizeof(Rgb8) + sizeof(float));
  constexpr std::size_t kFitting = (1U << 20U) / kImages;
  for (const ViewCandidate& candidate : selection_along_path(options, kFitting).take_chosen(1)) {
    ASSERT_FALSE(candidate.color.empty()) << candidate.frame;
    EXPECT_EQ(candidate.depth(3, 4), static_cast<float>(candidate.frame));
  }
  for (const ViewCandidate& candidate :
       selection_along_path(options, kFitting + 1).take_chosen(1)) {
    EXPECT_TRUE(candidate.color.empty() && candidate.depth.empty()) << candidate.frame;
  }
}

}  // namespace
}  // namespace pcavr
