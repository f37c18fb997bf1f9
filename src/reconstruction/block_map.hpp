// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "reconstruction/voxel_block.hpp"

namespace pcavr {

/// Place -> small number, by open addressing with linear probing.
class PlaceIndex {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  PlaceIndex();
  [[nodiscard]] std::uint32_t find(const BlockPlace& place) const;
  /// The place must not be there yet.
  void insert(const BlockPlace& place, std::uint32_t number);
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

/// All blocks, numbered in the order in which they were added, and grouped by regions of 8^3
/// blocks so that a frame looks only at regions in its view.
class BlockMap {
 public:
  static constexpr int kRegionSide = 8;  ///< blocks
  struct Region {
    BlockPlace place;  ///< in regions
    std::vector<std::uint32_t> blocks;
  };

  /// Number of the block there, or PlaceIndex::kNone.
  [[nodiscard]] std::uint32_t find(const BlockPlace& place) const { return index_.find(place); }
  /// Adds an empty block; there must be none at that place.
  std::uint32_t add(const BlockPlace& place);

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] const BlockPlace& place(std::uint32_t number) const { return places_[number]; }
  [[nodiscard]] VoxelBlock& block(std::uint32_t number) {
    return chunks_[number / kChunkBlocks][number % kChunkBlocks];
  }
  [[nodiscard]] const VoxelBlock& block(std::uint32_t number) const {
    return chunks_[number / kChunkBlocks][number % kChunkBlocks];
  }
  /// Frames that saw through the block as a whole, on top of what its voxels count.
  [[nodiscard]] std::uint8_t& through_whole(std::uint32_t number) { return through_whole_[number]; }
  [[nodiscard]] std::uint8_t through_whole(std::uint32_t number) const {
    return through_whole_[number];
  }
  [[nodiscard]] const std::vector<Region>& regions() const { return regions_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kChunkBlocks = 64;  ///< 256 KiB: growth never moves a block

  PlaceIndex index_;
  std::vector<BlockPlace> places_;
  std::vector<std::uint8_t> through_whole_;
  std::vector<std::unique_ptr<VoxelBlock[]>> chunks_;
  PlaceIndex region_index_;
  std::vector<Region> regions_;
};

}  // namespace pcavr
