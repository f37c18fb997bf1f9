// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/texture/atlas_packing.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {
namespace {

TEST(AtlasPacking, RectanglesLieInsideAndDoNotOverlap) {
  Random random(7);
  std::vector<Eigen::Vector2i> sizes;
  for (int i = 0; i < 300; ++i) {
    sizes.emplace_back(static_cast<int>(random.uniform(1.0, 30.0)),
                       static_cast<int>(random.uniform(1.0, 30.0)));
  }
  const auto corners = pack_rectangles(sizes, 256, 400);
  ASSERT_TRUE(corners);
  MaskImage used(256, 400);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    for (int y = 0; y < sizes[i].y(); ++y) {
      for (int x = 0; x < sizes[i].x(); ++x) {
        const Eigen::Vector2i at = (*corners)[i] + Eigen::Vector2i(x, y);
        ASSERT_TRUE(used.contains(at.x(), at.y()));
        EXPECT_EQ(used(at.x(), at.y()), 0) << "rectangle " << i;
        used(at.x(), at.y()) = 1;
      }
    }
  }
}

TEST(AtlasPacking, WhatDoesNotFitIsNotPacked) {
  EXPECT_TRUE(pack_rectangles({{8, 8}, {8, 8}}, 16, 8));
  EXPECT_FALSE(pack_rectangles({{8, 8}, {8, 8}, {1, 1}}, 16, 8));
  EXPECT_FALSE(pack_rectangles({{17, 1}}, 16, 8));
}

}  // namespace
}  // namespace pcavr
