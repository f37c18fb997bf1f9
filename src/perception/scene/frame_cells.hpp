// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// Cells are grouped in blocks of 8^3, and the cells of a block in eight words of 4^3 bits:
/// consecutive cells of a ray mostly share a word, and a block is one cache line.
inline constexpr int kBlockEdge = 8;
inline constexpr std::size_t kBlockCells = 512;
using BlockBits = std::array<std::uint64_t, kBlockCells / 64>;

/// Index of a cell in its block; `x`, `y`, `z` in [0, 8).
[[nodiscard]] constexpr std::size_t index_in_block(unsigned x, unsigned y, unsigned z) {
  return ((x >> 2) * 4 + (y >> 2) * 2 + (z >> 2)) * 64 + (x & 3) * 16 + (y & 3) * 4 + (z & 3);
}

/// The cells in which the rays of one frame end, and those that they traverse: a dense bit grid,
/// reused for each frame. All coordinates are in cells, so that cell (i, j, k) spans [i, i + 1)
/// etc.
class FrameCells {
 public:
  /// Clears, and resizes to the cells from `low` to `high`, both included.
  void reset(const Eigen::Vector3i& low, const Eigen::Vector3i& high);

  /// Marks a cell in which a ray ends. False if it was marked already.
  bool mark_hit(const Eigen::Vector3i& cell) { return set(hit_, bit_index_of(cell)); }
  /// Marks the cells from `origin` to `end` as traversed, except the last one: 3D DDA voxel
  /// traversal (the cells of [Amanatides & Woo 1987]), slab by slab along the ray's longest axis.
  void mark_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& end);

  /// Calls `visit(block, traversed, hit)` for each block with a mark, in a fixed order; `block` is
  /// its cells' coordinates / 8, and `traversed` excludes cells that are hit.
  template <typename Visit>
  void for_each_block(const Visit& visit) const;

 private:
  using Bits = std::vector<std::uint64_t>;

  [[nodiscard]] std::size_t bit_index_of(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i local = cell - min_;
    return bit_indices_[0][static_cast<std::size_t>(local.x())] +
           bit_indices_[1][static_cast<std::size_t>(local.y())] +
           bit_indices_[2][static_cast<std::size_t>(local.z())];
  }
  static bool set(Bits& bits, std::size_t bit_index) {
    std::uint64_t& word = bits[bit_index >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (bit_index & 63);
    const bool is_new = (word & bit) == 0;
    word |= bit;
    return is_new;
  }

  Eigen::Vector3i min_ = Eigen::Vector3i::Zero();          ///< a multiple of 8
  Eigen::Vector3i block_count_ = Eigen::Vector3i::Zero();  ///< along each axis
  /// A cell's bit index is the sum of one term for each of its coordinates.
  std::array<std::vector<std::size_t>, 3> bit_indices_;
  Bits traversed_;
  Bits hit_;
};

template <typename Visit>
void FrameCells::for_each_block(const Visit& visit) const {
  std::size_t first_word = 0;
  for (int x = 0; x < block_count_.x(); ++x) {
    for (int y = 0; y < block_count_.y(); ++y) {
      for (int z = 0; z < block_count_.z(); ++z) {
        BlockBits traversed;
        BlockBits hit;
        std::uint64_t any = 0;
        for (std::size_t i = 0; i < traversed.size(); ++i) {
          hit[i] = hit_[first_word + i];
          traversed[i] = traversed_[first_word + i] & ~hit[i];
          any |= hit[i] | traversed[i];
        }
        if (any != 0)
          visit(Eigen::Vector3i(min_ / kBlockEdge + Eigen::Vector3i(x, y, z)), traversed, hit);
        first_word += traversed.size();
      }
    }
  }
}

}  // namespace pcavr
