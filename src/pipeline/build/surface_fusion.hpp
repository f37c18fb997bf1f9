// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/perception/reconstruction/measured_cloud.hpp"
#include "pcavr/perception/reconstruction/tsdf_part.hpp"
#include "pcavr/pipeline/build_scene.hpp"

#include "fused_frame.hpp"

namespace pcavr {

/// The fused frames of a scene, or of a part of it.
struct SurfaceFusion {
  explicit SurfaceFusion(const BuildOptions& options, const std::optional<BlockBox>& part = {});

  void add(const FusedFrame& frame, const MaskImage& is_dynamic, const Pose& T_base_camera);
  /// Counts a frame that sees nothing of the part.
  void add_unseen();
  /// The points that frames measured on the mesh of the part, without outliers.
  [[nodiscard]] PointCloud points_on(const TriangleMesh& mesh_base,
                                     const SurfaceEvidence& evidence) const;

  TsdfPart volume;
  MeasuredCloud cloud;

 private:
  const BuildOptions& options_;
};

/// Distance from the mesh within which measured points are of its surface [m]. Points farther away
/// are of things that moved, or outliers.
[[nodiscard]] double max_mesh_distance(const BuildOptions& options);

/// Sizes of the levels of detail [triangles]: what a headset renders at 72 Hz, and two coarser ones
/// for distant views.
inline constexpr std::size_t kLevelOfDetailTriangles[] = {300'000, 75'000, 20'000};
/// Coarser levels of a first one, down to the last size.
void add_coarser_levels(const BuildOptions& options, std::vector<TriangleMesh>& levels);

}  // namespace pcavr
