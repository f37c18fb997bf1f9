// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/perception/scene/options.cpp for meanings, ranges and defaults.
struct OccupancyOptions {
  OccupancyOptions();

  double max_range;   ///< rays are truncated here [m]; by default the sensor's maximum depth
  double resolution;  ///< [m]
  double prob_hit;
  double prob_miss;
  double clamping_min;
  double clamping_max;
};

/// The options "scene.occupancy", without max_range.
[[nodiscard]] OptionSection section_of(OccupancyOptions& options);

/// Occupancy grid of the static scene: free, occupied or unknown cells. Frame: base. Integrates
/// depth images into blocks of 8^3 cells much faster than OctoMap, with OctoMap's update rule: one
/// ray to the centre of each cell that contains a measured point; cells in which a ray ends are
/// hits, other traversed cells are misses; each cell's log-odds are updated once per frame, and
/// clamped. One writer; const members may run concurrently. Memory: 1 KiB per observed block.
class OccupancyMap {
 public:
  /// Throws ContractError where an option is out of its range.
  explicit OccupancyMap(const OccupancyOptions& options = {});
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;

  [[nodiscard]] const OccupancyOptions& options() const;

  /// `is_dynamic` (empty: none) marks pixels that add neither hits nor free space. Depth, mask and
  /// camera have the same size. A frame farther from base than OctoMap's key range (32 000 cells)
  /// is ignored.
  void integrate(const DepthImage& depth, const MaskImage& is_dynamic, const CameraModel& camera,
                 const Pose& T_base_camera);

  /// Clears the occupied cells without a triangle of the static mesh within half a cell: traces of
  /// a moving tool or object, and outliers. They become unknown, not free, as no ray traversed
  /// them. Returns their number.
  std::size_t clear_unsupported(const TriangleMesh& static_mesh_base);

  /// Marks the cells that a surface intersects as occupied: geometry known without measurements.
  void mark_occupied(const TriangleMesh& mesh_base);

  enum class Cell { unknown, free, occupied };
  [[nodiscard]] Cell at(const Eigen::Vector3d& p_base) const;

  struct Counts {
    std::size_t free = 0;
    std::size_t occupied = 0;
  };
  [[nodiscard]] Counts counts() const;

  [[nodiscard]] std::size_t memory_bytes() const;

  /// Writes a pruned OctoMap binary tree (`.bt`).
  [[nodiscard]] Expected<void> write(const std::filesystem::path& file) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
