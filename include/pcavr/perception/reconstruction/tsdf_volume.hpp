// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/perception/reconstruction/options.cpp for meanings, ranges and defaults.
struct TsdfOptions {
  TsdfOptions();
  explicit TsdfOptions(double voxel_size);

  DepthNoise depth_noise;
  double voxel_size;         ///< [m]
  double truncation_voxels;  ///< [voxels]
  double truncation_std;     ///< [standard deviations of depth]
  int frames_to_clear;
};

/// The options "reconstruction.fusion".
[[nodiscard]] OptionSection section_of(TsdfOptions& options);

struct IntegrationReport {
  std::size_t pixels_used = 0;
  std::size_t blocks_visible = 0;
  std::size_t blocks_added = 0;
};

/// Frames that must have measured a voxel for its surface to be extracted; clamped to [1, 15].
struct SurfaceEvidence {
  double min_weight = 1.0;                 ///< [frames], where any frame observed it as free
  double min_uncontradicted_weight = 1.0;  ///< [frames], where none did
};

/// A truncated signed distance function (TSDF) with colour, in a sparse hash of blocks of 8^3
/// voxels near surfaces (voxel hashing) [Curless & Levoy 1996; Niessner et al. 2013]. Frame: base.
/// One writer; const members may run concurrently. The content is bitwise identical for any number
/// of threads.
class TsdfVolume {
 public:
  explicit TsdfVolume(const TsdfOptions& options);
  ~TsdfVolume();
  TsdfVolume(TsdfVolume&&) noexcept;

  /// `is_dynamic` (empty: none) marks pixels that show no part of the static scene: they add no
  /// surface, but the space in front of them is observed as free. Depth, colour (may be empty) and
  /// mask share one pixel grid. Run filter_depth first, to remove flying pixels.
  IntegrationReport integrate(const DepthImage& depth, const ColorImage& color,
                              const MaskImage& is_dynamic, const CameraModel& camera,
                              const Pose& T_base_camera, Parallelism parallelism);

  /// Marching cubes [Lorensen & Cline 1987] with shared vertices, normals from the distance
  /// field's gradient, and colours. Voxels that fewer than `min_weight` frames
  /// measured are ignored; clamped to [1, 15].
  [[nodiscard]] TriangleMesh extract_mesh(double min_weight, Parallelism parallelism) const;
  /// The same, with fewer frames where nothing contradicts them.
  [[nodiscard]] TriangleMesh extract_mesh(const SurfaceEvidence& evidence,
                                          Parallelism parallelism) const;

  [[nodiscard]] std::size_t block_count() const;
  [[nodiscard]] std::size_t memory_bytes() const;
  [[nodiscard]] const TsdfOptions& options() const;

 private:
  struct Blocks;
  std::unique_ptr<Blocks> blocks_;
};

}  // namespace pcavr
