// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "perception/reconstruction/block_map.hpp"
#include "perception/reconstruction/voxel_block.hpp"

namespace pcavr {

/// The distance of a voxel that is not known.
inline constexpr std::int16_t kUnknownDistance = std::numeric_limits<std::int16_t>::min();

/// The signed distances of a block's voxels, or kUnknownDistance.
using Distances = std::array<std::int16_t, kBlockVoxels>;

/// Numbers of the 3x3x3 blocks around a block, x fastest.
using Neighbours = std::array<std::uint32_t, 27>;
[[nodiscard]] Neighbours neighbours_of(const BlockMap& map, std::uint32_t number);

/// Voxels -1 to 9 of a block on each axis, including its neighbours' voxels.
class Window {
 public:
  static constexpr int kSide = kBlockSide + 3;  ///< with neighbours for cubes and gradients

  Window(const std::vector<Distances>& distances, const Neighbours& neighbours) {
    for (int z = -1; z <= 9; ++z) {
      for (int y = -1; y <= 9; ++y) copy_row(distances, neighbours, y, z);
    }
  }
  [[nodiscard]] std::int16_t operator()(int x, int y, int z) const {
    return values_[index(x, y, z)];
  }

 private:
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(((z + 1) * kSide + y + 1) * kSide + x + 1);
  }
  void copy_row(const std::vector<Distances>& distances, const Neighbours& neighbours, int y,
                int z) {
    // (v + 8) / 8 is 0, 1, 2 for the block before, this one, the block after.
    const int side = (z + 8) / 8 * 9 + (y + 8) / 8 * 3;
    const int row = (((z + 8) % 8) * kBlockSide + (y + 8) % 8) * kBlockSide;
    const auto copy = [&](int block, int from, int count, int to) {
      std::int16_t* target = values_.data() + index(to, y, z);
      const std::uint32_t number = neighbours[static_cast<std::size_t>(side + block)];
      if (number == BlockHashTable::kNone) {
        std::fill_n(target, count, kUnknownDistance);
      } else {
        std::copy_n(distances[number].data() + row + from, count, target);
      }
    };
    copy(0, 7, 1, -1);
    copy(1, 0, 8, 0);
    copy(2, 0, 2, 8);
  }

  std::array<std::int16_t, kSide * kSide * kSide> values_;
};

}  // namespace pcavr
