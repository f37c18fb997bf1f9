// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/mesh.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

struct OccupancyOptions {
  double resolution = 0.02;  ///< edge of a cell [m], > 0
  double farthest = 5.0;     ///< rays are cut here [m], >= resolution
  // OctoMap's defaults [Hornung et al. 2013, sec. 3 and 4], as probabilities.
  double hit = 0.7;           ///< of a cell that a ray ends in, > 0.5
  double miss = 0.4;          ///< of a cell that a ray passes, < 0.5
  double clamp_low = 0.1192;  ///< a cell is never surer to be free than this
  double clamp_high = 0.971;  ///< nor surer to be occupied than this
};

/// Which cells of the static scene are free, occupied or never seen. Frame: base. Integrates depth
/// images into blocks of 8^3 cells much faster than OctoMap does, with OctoMap's rule for one
/// frame: one ray to the middle of each cell that a reading falls into; cells that a ray ends in
/// are hit, the others that a ray passes are missed; each cell is updated once, and clamped. One
/// writer; const members may run side by side. Memory: 1 KiB for each block seen.
class OccupancyMap {
 public:
  /// Throws ContractError where an option is out of its range.
  explicit OccupancyMap(const OccupancyOptions& options = {});
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;

  [[nodiscard]] const OccupancyOptions& options() const;

  /// `is_dynamic` (empty: none) marks pixels that add neither hits nor free space. Depth, mask and
  /// camera have one size. A frame farther from base than OctoMap can hold (32 000 cells) adds
  /// nothing.
  void integrate(const DepthImage& depth, const MaskImage& is_dynamic, const CameraModel& camera,
                 const Pose& T_base_camera);

  /// Forgets the occupied cells that no triangle of the static mesh comes near (half a cell): what
  /// a passing tool or a moved object left behind, and single readings. They become unknown, not
  /// free: nothing was seen through them. Returns how many there were.
  std::size_t clear_unsupported(const TriangleMesh& static_mesh_base);

  /// Marks the cells that a surface passes as occupied: what is known without having been seen.
  void occupy(const TriangleMesh& mesh_base);

  enum class Cell { unknown, free, occupied };
  [[nodiscard]] Cell at(const Eigen::Vector3d& p_base) const;

  struct Counts {
    std::size_t free = 0;
    std::size_t occupied = 0;
  };
  [[nodiscard]] Counts counts() const;

  [[nodiscard]] std::size_t memory_bytes() const;

  /// As an OctoMap binary tree (`.bt`), pruned.
  [[nodiscard]] Expected<void> write(const std::filesystem::path& file) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
