// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace pcavr {

inline constexpr int kBlockSide = 8;  ///< voxels; a row is one 256-bit register of 32-bit lanes
inline constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;

/// Quantisation steps of the stored distance per voxel: 10 um at 5 mm, far below the noise; 16 bits
/// cover +-64 voxels.
inline constexpr int kDistanceSteps = 512;
/// Weight units of the best possible measurement. 16 bits hold 256 of them, after which the mean
/// becomes a moving average; the worst measurement counts as one unit.
inline constexpr int kWeightUnits = 256;
inline constexpr std::uint32_t kMaxWeight = 65535;
/// Both frame counters have four bits.
inline constexpr std::uint32_t kMaxCount = 15;

/// 8^3 voxels, x fastest, 8 bytes per voxel: two arrays of 32-bit lanes, as the kernel loads them.
struct VoxelBlock {
  /// Low 16 bits: signed distance in steps (two's complement, positive in front of the surface).
  /// High 16 bits: weight in units.
  alignas(64) std::array<std::uint32_t, kBlockVoxels> distance_weight;
  /// Red, green, blue from the lowest byte (all 0: no colour yet); then four bits for the number of
  /// frames that measured the voxel and four for those that observed it as free, both saturating.
  alignas(64) std::array<std::uint32_t, kBlockVoxels> color_counts;
};
static_assert(sizeof(VoxelBlock) == 8 * kBlockVoxels);

[[nodiscard]] inline int distance_steps(std::uint32_t distance_weight) {
  return static_cast<std::int16_t>(distance_weight & 0xFFFFU);
}
[[nodiscard]] inline std::uint32_t hit_count(std::uint32_t color_counts) {
  return (color_counts >> 24) & 15U;
}
[[nodiscard]] inline std::uint32_t free_count(std::uint32_t color_counts) {
  return color_counts >> 28;
}

/// Coordinates of a block: its first voxel has the grid coordinates 8 * (x, y, z).
struct BlockCoordinates {
  int x = 0;
  int y = 0;
  int z = 0;
  bool operator==(const BlockCoordinates&) const = default;
};

}  // namespace pcavr
