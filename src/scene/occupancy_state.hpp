// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "pcavr/scene/occupancy_map.hpp"

#include "frame_cells.hpp"

namespace pcavr {

/// What OctoMap's 16-bit keys can hold [cells from base].
inline constexpr double kFarthestCell = 32000.0;

inline constexpr std::int16_t kUnknown = std::numeric_limits<std::int16_t>::min();

/// 8^3 cells. Their values are log-odds in units of the map's own; >= 0 is occupied, as in OctoMap.
struct OccupancyBlock {
  explicit OccupancyBlock(const Eigen::Vector3i& at) : position(at) { values.fill(kUnknown); }

  Eigen::Vector3i position;  ///< of its first cell, over 8
  std::array<std::int16_t, kBlockCells> values;
};

struct OccupancyMap::State {
  explicit State(const OccupancyOptions& chosen);

  OccupancyOptions options;
  double units_per_log_odds = 0.0;
  int clamp_low = 0;
  int clamp_high = 0;
  int hit_update = 0;
  int miss_update = 0;

  std::vector<OccupancyBlock> blocks;  ///< in the order in which they were first seen
  std::unordered_map<std::uint64_t, std::size_t> index_of_block;

  // Scratch of integrate(), kept to spare the allocations.
  FrameCells frame;
  CameraModel ray_camera;
  std::vector<Eigen::Vector2f> rays;       ///< x and y at z = 1, by pixel
  std::vector<Eigen::Vector3i> end_cells;  ///< that readings fall into; some more than once

  const std::vector<Eigen::Vector2f>& rays_of(const CameraModel& camera);
  /// Fills `end_cells`. `origin` is the camera's position [cells].
  void collect_ends(const DepthImage& depth, const MaskImage& is_dynamic, const CameraModel& camera,
                    const Pose& T_base_camera, const Eigen::Vector3d& origin);
  /// Marks in `frame` what the rays to `end_cells` pass and end in.
  void trace(const Eigen::Vector3d& origin);
  void update_from_frame();

  [[nodiscard]] OccupancyBlock& block_at(const Eigen::Vector3i& position);
  struct Place {
    std::size_t block = 0;  ///< in blocks
    std::size_t index = 0;  ///< in its values
  };
  /// Where a cell's value stands; nothing where its block was never seen.
  [[nodiscard]] std::optional<Place> place_of(const Eigen::Vector3i& cell) const;

  /// 21 bits for each coordinate.
  [[nodiscard]] static std::uint64_t block_key(const Eigen::Vector3i& block) {
    const auto bits = [](int c) { return static_cast<std::uint64_t>(c) & 0x1FFFFFU; };
    return bits(block.x()) << 42 | bits(block.y()) << 21 | bits(block.z());
  }
};

}  // namespace pcavr
