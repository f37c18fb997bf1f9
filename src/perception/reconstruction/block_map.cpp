// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/block_map.hpp"

namespace pcavr {
namespace {

// 21 bits per axis: +-8 km at 1 mm voxels.
std::uint64_t key_of(const BlockCoordinates& coordinates) {
  const auto bits = [](int value) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value)) & 0x1FFFFFU;
  };
  return bits(coordinates.x) | (bits(coordinates.y) << 21) | (bits(coordinates.z) << 42);
}

// The finaliser of MurmurHash3: spreads neighbouring keys.
std::size_t hash_of(std::uint64_t key) {
  key ^= key >> 33;
  key *= 0xFF51AFD7ED558CCDULL;
  key ^= key >> 33;
  key *= 0xC4CEB9FE1A85EC53ULL;
  key ^= key >> 33;
  return static_cast<std::size_t>(key);
}

int floor_divided(int value, int by) { return value >= 0 ? value / by : -((by - 1 - value) / by); }

}  // namespace

BlockHashTable::BlockHashTable() : slots_(1024, Slot{0, kNone}) {}

std::uint32_t BlockHashTable::find(const BlockCoordinates& coordinates) const {
  const std::uint64_t key = key_of(coordinates);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = hash_of(key) & mask;; i = (i + 1) & mask) {
    if (slots_[i].number == kNone || slots_[i].key == key) return slots_[i].number;
  }
}

void BlockHashTable::insert(const BlockCoordinates& coordinates, std::uint32_t number) {
  if (2 * (used_ + 1) > slots_.size()) grow();
  const std::uint64_t key = key_of(coordinates);
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = hash_of(key) & mask;
  while (slots_[i].number != kNone) i = (i + 1) & mask;
  slots_[i] = {key, number};
  ++used_;
}

void BlockHashTable::grow() {
  std::vector<Slot> old(slots_.size() * 2, Slot{0, kNone});
  old.swap(slots_);
  const std::size_t mask = slots_.size() - 1;
  for (const Slot& slot : old) {
    if (slot.number == kNone) continue;
    std::size_t i = hash_of(slot.key) & mask;
    while (slots_[i].number != kNone) i = (i + 1) & mask;
    slots_[i] = slot;
  }
}

std::uint32_t BlockMap::add(const BlockCoordinates& coordinates) {
  const auto number = static_cast<std::uint32_t>(coordinates_.size());
  if (number % kChunkBlocks == 0) chunks_.push_back(std::make_unique<VoxelBlock[]>(kChunkBlocks));
  coordinates_.push_back(coordinates);
  block_free_counts_.push_back(0);
  index_.insert(coordinates, number);

  const BlockCoordinates region{floor_divided(coordinates.x, kRegionSide),
                                floor_divided(coordinates.y, kRegionSide),
                                floor_divided(coordinates.z, kRegionSide)};
  std::uint32_t region_number = region_index_.find(region);
  if (region_number == BlockHashTable::kNone) {
    region_number = static_cast<std::uint32_t>(regions_.size());
    region_index_.insert(region, region_number);
    regions_.push_back({region, {}});
  }
  regions_[region_number].blocks.push_back(number);
  return number;
}

std::size_t BlockMap::memory_bytes() const {
  std::size_t bytes = chunks_.size() * kChunkBlocks * sizeof(VoxelBlock);
  bytes += index_.memory_bytes() + region_index_.memory_bytes();
  bytes += coordinates_.capacity() * sizeof(BlockCoordinates) + block_free_counts_.capacity();
  for (const Region& region : regions_) {
    bytes += sizeof(Region) + region.blocks.capacity() * sizeof(std::uint32_t);
  }
  return bytes;
}

}  // namespace pcavr
