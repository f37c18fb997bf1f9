// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// Cells are grouped in blocks of 8^3, and the cells of a block in eight words of 4^3 bits: the
/// neighbours that a ray visits in turn mostly share a word, and a block is one cache line.
inline constexpr int kBlockEdge = 8;
inline constexpr std::size_t kBlockCells = 512;
using BlockBits = std::array<std::uint64_t, kBlockCells / 64>;

/// Where a cell stands in its block; `x`, `y`, `z` in [0, 8).
[[nodiscard]] constexpr std::size_t index_in_block(unsigned x, unsigned y, unsigned z) {
  return ((x >> 2) * 4 + (y >> 2) * 2 + (z >> 2)) * 64 + (x & 3) * 16 + (y & 3) * 4 + (z & 3);
}

/// The cells that the rays of one frame end in and pass through: a dense box of bits, used anew for
/// each frame. All coordinates are in cells, so that cell (i, j, k) spans [i, i + 1) and so on.
class FrameCells {
 public:
  /// Clears, and makes room for the cells from `low` to `high`, both included.
  void reset(const Eigen::Vector3i& low, const Eigen::Vector3i& high);

  /// Marks the cell as one that a ray ends in. False if it was so already.
  bool mark_hit(const Eigen::Vector3i& cell) { return set(hit_, code_of(cell)); }
  /// Marks the cells from `origin` to `end` as passed, the last one left out: the cells of
  /// [Amanatides & Woo 1987], slab by slab along the ray's longest axis.
  void mark_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& end);

  /// Calls `visit(block, passed, hit)` for each block with a mark, in a fixed order; `block` is
  /// its cells' coordinates over 8, and passed cells that are hit too are left out.
  template <typename Visit>
  void for_each_block(const Visit& visit) const;

 private:
  using Bits = std::vector<std::uint64_t>;

  [[nodiscard]] std::size_t code_of(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i local = cell - low_;
    return codes_[0][static_cast<std::size_t>(local.x())] +
           codes_[1][static_cast<std::size_t>(local.y())] +
           codes_[2][static_cast<std::size_t>(local.z())];
  }
  static bool set(Bits& bits, std::size_t code) {
    std::uint64_t& word = bits[code >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (code & 63);
    const bool is_new = (word & bit) == 0;
    word |= bit;
    return is_new;
  }

  Eigen::Vector3i low_ = Eigen::Vector3i::Zero();          ///< a multiple of 8
  Eigen::Vector3i block_count_ = Eigen::Vector3i::Zero();  ///< along each axis
  /// A cell's bit is the sum of one code for each of its coordinates.
  std::array<std::vector<std::size_t>, 3> codes_;
  Bits passed_;
  Bits hit_;
};

template <typename Visit>
void FrameCells::for_each_block(const Visit& visit) const {
  std::size_t first_word = 0;
  for (int x = 0; x < block_count_.x(); ++x) {
    for (int y = 0; y < block_count_.y(); ++y) {
      for (int z = 0; z < block_count_.z(); ++z) {
        BlockBits passed;
        BlockBits hit;
        std::uint64_t any = 0;
        for (std::size_t i = 0; i < passed.size(); ++i) {
          hit[i] = hit_[first_word + i];
          passed[i] = passed_[first_word + i] & ~hit[i];
          any |= hit[i] | passed[i];
        }
        if (any != 0)
          visit(Eigen::Vector3i(low_ / kBlockEdge + Eigen::Vector3i(x, y, z)), passed, hit);
        first_word += passed.size();
      }
    }
  }
}

}  // namespace pcavr
