// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/texture/view_selection.hpp"

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
                  {});
  }
  const std::vector<ViewCandidate> chosen = selection.chosen(1);
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen.front().frame, 3U);
}

TEST(ViewSelection, BoundsNumberAndMemory) {
  TextureOptions options;
  options.max_views = 10;
  options.max_view_memory = 16;
  ViewSelection selection(options);
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto x = 0.1 * static_cast<double>(i);
    selection.add(i, at_seconds(x), Pose::from_translation({x, 0, 0}), striped(50), {});
  }
  EXPECT_GE(selection.chosen(1).size(), 5U);
  EXPECT_LE(selection.chosen(1).size(), 10U);
  EXPECT_EQ(selection.chosen(8U << 20U).size(), 2U);  // 8 MiB each
}

}  // namespace
}  // namespace pcavr
