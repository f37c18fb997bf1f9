// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "perception/reconstruction/voxel_block.hpp"

namespace pcavr {

/// Hash table from block coordinates to block number: open addressing with linear probing.
class BlockHashTable {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  BlockHashTable();
  [[nodiscard]] std::uint32_t find(const BlockCoordinates& coordinates) const;
  /// The coordinates must not be in the table yet.
  void insert(const BlockCoordinates& coordinates, std::uint32_t number);
  [[nodiscard]] std::size_t memory_bytes() const { return slots_.capacity() * sizeof(Slot); }

 private:
  struct Slot {
    std::uint64_t key;
    std::uint32_t number;
  };
  void grow();

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

/// All blocks, numbered in the order in which they were added, and grouped by regions of 8^3 blocks
/// for frustum culling.
class BlockMap {
 public:
  static constexpr int kRegionSide = 8;  ///< blocks
  struct Region {
    BlockCoordinates coordinates;  ///< [regions]
    std::vector<std::uint32_t> blocks;
  };

  /// Number of the block with these coordinates, or BlockHashTable::kNone.
  [[nodiscard]] std::uint32_t find(const BlockCoordinates& coordinates) const {
    return index_.find(coordinates);
  }
  /// Adds an empty block; none may exist with these coordinates.
  std::uint32_t add(const BlockCoordinates& coordinates);

  [[nodiscard]] std::size_t size() const { return coordinates_.size(); }
  [[nodiscard]] const BlockCoordinates& coordinates(std::uint32_t number) const {
    return coordinates_[number];
  }
  [[nodiscard]] VoxelBlock& block(std::uint32_t number) {
    return chunks_[number / kChunkBlocks][number % kChunkBlocks];
  }
  [[nodiscard]] const VoxelBlock& block(std::uint32_t number) const {
    return chunks_[number / kChunkBlocks][number % kChunkBlocks];
  }
  /// Frames that observed the whole block as free, in addition to its voxels' free counts.
  [[nodiscard]] std::uint8_t& block_free_count(std::uint32_t number) {
    return block_free_counts_[number];
  }
  [[nodiscard]] std::uint8_t block_free_count(std::uint32_t number) const {
    return block_free_counts_[number];
  }
  [[nodiscard]] const std::vector<Region>& regions() const { return regions_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kChunkBlocks = 64;  ///< 256 KiB; blocks have stable addresses

  BlockHashTable index_;
  std::vector<BlockCoordinates> coordinates_;
  std::vector<std::uint8_t> block_free_counts_;
  std::vector<std::unique_ptr<VoxelBlock[]>> chunks_;
  BlockHashTable region_index_;
  std::vector<Region> regions_;
};

}  // namespace pcavr
