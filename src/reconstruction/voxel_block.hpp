// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace pcavr {

inline constexpr int kBlockSide = 8;  ///< voxels; a row is one 256-bit register of 32-bit lanes
inline constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;

/// Steps of the stored distance in one voxel: 10 um at 5 mm, far below the noise of any mean; the
/// 16 bits then reach 64 voxels to either side.
inline constexpr int kDistanceSteps = 512;
/// Weight units of the best measurement there is. 16 bits hold 256 of them, after which old frames
/// fade; the worst measurement still counts as one unit.
inline constexpr int kWeightUnits = 256;
inline constexpr std::uint32_t kMaxWeight = 65535;
/// Both frame counters have four bits.
inline constexpr std::uint32_t kMaxCount = 15;

/// 8^3 voxels, x fastest, in 8 bytes a voxel: two arrays of 32-bit lanes, as the kernel loads them.
struct VoxelBlock {
  /// Low 16 bits: signed distance in steps (two's complement, positive in front of the surface).
  /// High 16 bits: weight in units.
  alignas(64) std::array<std::uint32_t, kBlockVoxels> distance_weight;
  /// Red, green, blue from the lowest byte up (0 together: no colour yet); then four bits for the
  /// frames that measured the voxel and four for those that saw through it, both saturating.
  alignas(64) std::array<std::uint32_t, kBlockVoxels> color_counts;
};
static_assert(sizeof(VoxelBlock) == 8 * kBlockVoxels);

[[nodiscard]] inline int distance_steps(std::uint32_t distance_weight) {
  return static_cast<std::int16_t>(distance_weight & 0xFFFFU);
}
[[nodiscard]] inline std::uint32_t hit_count(std::uint32_t color_counts) {
  return (color_counts >> 24) & 15U;
}
[[nodiscard]] inline std::uint32_t through_count(std::uint32_t color_counts) {
  return color_counts >> 28;
}

/// Place of a block: its lowest voxel is number 8 * (x, y, z) of the grid.
struct BlockPlace {
  int x = 0;
  int y = 0;
  int z = 0;
  bool operator==(const BlockPlace&) const = default;
};

}  // namespace pcavr
