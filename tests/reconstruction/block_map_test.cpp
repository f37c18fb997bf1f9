// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/block_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

struct CoordinatesHash {
  std::size_t operator()(const BlockCoordinates& block) const {
    return std::hash<double>()(block.x + 3e6 * block.y + 9e12 * block.z);
  }
};

/// A block within `side` of the corners, borders and centre of the range of 21 bits: neighbours,
/// negative coordinates and those that differ in one bit only.
BlockCoordinates random_block(Random& random, int side) {
  constexpr int kRange = 1 << 20;
  const auto draw = [&] {
    const int offset = static_cast<int>(random.below(static_cast<std::uint64_t>(2 * side))) - side;
    switch (random.below(3)) {
      case 0:
        return std::max(offset, -offset) - kRange;
      case 1:
        return kRange - 1 - std::max(offset, -offset);
      default:
        return offset;
    }
  };
  const int x = draw();
  const int y = draw();
  return {x, y, draw()};
}

TEST(BlockHashTable, AgreesWithAStandardMap) {
  for (const int side : {4, 100, 100'000}) {
    Random random(static_cast<std::uint64_t>(side));
    BlockHashTable table;
    std::unordered_map<BlockCoordinates, std::uint32_t, CoordinatesHash> reference;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
      const BlockCoordinates block = random_block(random, side);
      const auto known = reference.find(block);
      ASSERT_EQ(table.find(block),
                known == reference.end() ? BlockHashTable::kNone : known->second);
      if (known != reference.end()) continue;
      table.insert(block, i);
      reference[block] = i;
    }
    // The table finds all blocks after it has grown, too.
    for (const auto& [block, number] : reference) ASSERT_EQ(table.find(block), number);
  }
}

TEST(BlockMap, KeepsBlocksInOrderAtStableAddressesAndInTheirRegions) {
  Random random(2);
  BlockMap map;
  std::vector<BlockCoordinates> added;
  std::vector<const VoxelBlock*> addresses;
  while (added.size() < 3000) {
    const BlockCoordinates block = random_block(random, 20);
    if (map.find(block) != BlockHashTable::kNone) continue;
    const std::uint32_t number = map.add(block);
    ASSERT_EQ(number, added.size());
    added.push_back(block);
    addresses.push_back(&map.block(number));
    const auto is_zero = [](std::uint32_t word) { return word == 0; };
    ASSERT_TRUE(std::all_of(map.block(number).distance_weight.begin(),
                            map.block(number).distance_weight.end(), is_zero));
    ASSERT_TRUE(std::all_of(map.block(number).color_counts.begin(),
                            map.block(number).color_counts.end(), is_zero));
    ASSERT_EQ(map.block_free_count(number), 0);
  }
  ASSERT_EQ(map.size(), added.size());
  for (std::uint32_t i = 0; i < added.size(); ++i) {
    EXPECT_EQ(map.coordinates(i), added[i]);
    EXPECT_EQ(&map.block(i), addresses[i]);
  }
  std::vector<int> occurrences(added.size(), 0);
  std::map<std::tuple<int, int, int>, int> regions;
  for (const BlockMap::Region& region : map.regions()) {
    const BlockCoordinates& at = region.coordinates;
    EXPECT_EQ((++regions[{at.x, at.y, at.z}]), 1);
    for (const std::uint32_t number : region.blocks) {
      ++occurrences[number];
      const auto region_of = [](int c) { return std::floor(c / double{BlockMap::kRegionSide}); };
      EXPECT_EQ(region_of(added[number].x), at.x);
      EXPECT_EQ(region_of(added[number].y), at.y);
      EXPECT_EQ(region_of(added[number].z), at.z);
    }
  }
  for (const int count : occurrences) EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace pcavr
