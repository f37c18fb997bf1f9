// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

struct TsdfOptions {
  double voxel_size = 0.005;  ///< [m], > 0. Halving it costs four times the surface voxels.
  /// Truncation distance of the signed distance, in voxels. Too small: noise causes holes; too
  /// large: thin walls and edges thicken. It is widened with the depth noise (3 standard
  /// deviations).
  double truncation_voxels = 4.0;  ///< >= 2
  DepthNoise depth_noise = {};
  /// Space carving: a voxel that this many frames have observed as free holds no surface, whatever
  /// other frames measured there; 1 to 15. More: moved objects remain; fewer: single bad frames
  /// cause holes.
  int frames_to_clear = 3;
};

struct IntegrationReport {
  std::size_t pixels_used = 0;
  std::size_t blocks_visible = 0;
  std::size_t blocks_added = 0;
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

  [[nodiscard]] std::size_t block_count() const;
  [[nodiscard]] std::size_t memory_bytes() const;
  [[nodiscard]] const TsdfOptions& options() const;

 private:
  struct Blocks;
  std::unique_ptr<Blocks> blocks_;
};

}  // namespace pcavr
