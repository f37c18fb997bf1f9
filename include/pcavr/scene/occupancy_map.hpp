// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

struct OccupancyOptions {
  double resolution = 0.02;  ///< edge of a cell [m]
  double farthest = 5.0;     ///< rays are cut here [m]
  // OctoMap's defaults [Hornung et al. 2013, sec. 3 and 4], as log-odds probabilities.
  double hit = 0.7;
  double miss = 0.4;
  double clamp_low = 0.1192;
  double clamp_high = 0.971;
};

/// Which cells of the static scene are free, occupied or never seen. Integrates depth images into
/// blocks of cells much faster than OctoMap does, with OctoMap's rule for a cell hit and missed in
/// one frame; written as an OctoMap. One writer.
class OccupancyMap {
 public:
  explicit OccupancyMap(const OccupancyOptions& options = {});
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;

  /// `is_dynamic` (empty: none) marks pixels that add neither hits nor free space.
  void integrate(const DepthImage& depth, const MaskImage& is_dynamic, const CameraModel& camera,
                 const Pose& T_base_camera);

  enum class Cell { unknown, free, occupied };
  [[nodiscard]] Cell at(const Eigen::Vector3d& p_base) const;

  struct Counts {
    std::size_t free = 0;
    std::size_t occupied = 0;
  };
  [[nodiscard]] Counts counts() const;

  /// As an OctoMap binary tree (`.bt`), pruned.
  [[nodiscard]] Expected<void> write(const std::filesystem::path& file) const;

 private:
  struct Blocks;
  std::unique_ptr<Blocks> blocks_;
};

}  // namespace pcavr
