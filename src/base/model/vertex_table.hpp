// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace pcavr::model {

/// Bitwise comparison, except that minus zero equals zero; unlike ==, also for NaN.
[[nodiscard]] inline bool is_identical(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); };
  return bits(a.x()) == bits(b.x()) && bits(a.y()) == bits(b.y()) && bits(a.z()) == bits(b.z());
}
/// Equal for values that are identical.
[[nodiscard]] inline std::uint64_t hash_of(const Eigen::Vector3f& p, std::uint64_t seed = 0) {
  std::uint64_t mixed = seed;
  for (int axis = 0; axis < 3; ++axis) {
    mixed = (mixed ^ std::bit_cast<std::uint32_t>(p[axis] + 0.0F)) * 0x9E3779B97F4A7C15ULL;
    mixed ^= mixed >> 32U;
  }
  return mixed;
}

/// Hash table of vertex indices: open addressing, 8 to 16 bytes per vertex. The caller stores the
/// vertices.
class VertexTable {
 public:
  explicit VertexTable(std::size_t expected = 0) {
    slots_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * expected)), kNone);
  }

  /// The stored index with `hash` for which is_same(index) holds; if there is none, `index` is
  /// inserted and returned. `rehash(index)` is the hash of a stored index.
  template <typename IsSame, typename Rehash>
  std::uint32_t find_or_insert(std::uint64_t hash, std::uint32_t index, const IsSame& is_same,
                               const Rehash& rehash) {
    if (2 * (size_ + 1) > slots_.size()) grow(rehash);
    for (std::size_t slot = hash & mask();; slot = (slot + 1) & mask()) {
      if (slots_[slot] == kNone) {
        slots_[slot] = index;
        ++size_;
        return index;
      }
      if (is_same(slots_[slot])) return slots_[slot];
    }
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  [[nodiscard]] std::size_t mask() const { return slots_.size() - 1; }
  template <typename Rehash>
  void grow(const Rehash& rehash) {
    std::vector<std::uint32_t> old = std::exchange(slots_, {});
    slots_.assign(2 * old.size(), kNone);
    for (const std::uint32_t index : old) {
      if (index == kNone) continue;
      std::size_t slot = rehash(index) & mask();
      while (slots_[slot] != kNone) slot = (slot + 1) & mask();
      slots_[slot] = index;
    }
  }

  std::vector<std::uint32_t> slots_;
  std::size_t size_ = 0;
};

}  // namespace pcavr::model
