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

#include "pcavr/perception/scene/occupancy_map.hpp"

#include "frame_cells.hpp"

namespace pcavr {

/// Range of OctoMap's 16-bit keys [cells from base].
inline constexpr double kMaxCell = 32000.0;

inline constexpr std::int16_t kUnknown = std::numeric_limits<std::int16_t>::min();

/// 8^3 cells. Values are fixed-point log-odds; >= 0 is occupied, as in OctoMap.
struct OccupancyBlock {
  explicit OccupancyBlock(const Eigen::Vector3i& at) : position(at) { values.fill(kUnknown); }

  Eigen::Vector3i position;  ///< of its first cell / 8
  std::array<std::int16_t, kBlockCells> values;
};

struct OccupancyMap::State {
  explicit State(const OccupancyOptions& chosen);

  OccupancyOptions options;
  double units_per_log_odds = 0.0;
  int clamping_min = 0;
  int clamping_max = 0;
  int hit_update = 0;
  int miss_update = 0;

  std::vector<OccupancyBlock> blocks;  ///< in the order in which they were first observed
  std::unordered_map<std::uint64_t, std::size_t> index_of_block;

  // Scratch buffers of integrate(), reused to avoid allocations.
  FrameCells frame;
  CameraModel ray_camera;
  std::vector<Eigen::Vector2f> rays;       ///< x and y at z = 1, by pixel
  std::vector<Eigen::Vector3i> end_cells;  ///< that contain measured points; may have duplicates

  const std::vector<Eigen::Vector2f>& rays_of(const CameraModel& camera);
  /// Fills `end_cells`. `origin` is the camera's position [cells].
  void collect_ends(const DepthImage& depth, const MaskImage& is_dynamic, const CameraModel& camera,
                    const Pose& T_base_camera, const Eigen::Vector3d& origin);
  /// Marks in `frame` the cells that the rays to `end_cells` traverse and end in.
  void trace(const Eigen::Vector3d& origin);
  void update_from_frame();

  [[nodiscard]] OccupancyBlock& block_at(const Eigen::Vector3i& position);
  struct CellIndex {
    std::size_t block = 0;  ///< in blocks
    std::size_t cell = 0;   ///< in its values
  };
  /// Index of a cell's value; nullopt where its block was never observed.
  [[nodiscard]] std::optional<CellIndex> index_of(const Eigen::Vector3i& cell) const;

  /// 21 bits for each coordinate.
  [[nodiscard]] static std::uint64_t block_key(const Eigen::Vector3i& block) {
    const auto bits = [](int c) { return static_cast<std::uint64_t>(c) & 0x1FFFFFU; };
    return bits(block.x()) << 42 | bits(block.y()) << 21 | bits(block.z());
  }
};

}  // namespace pcavr
