// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "pcavr/perception/reconstruction/surface_tiles.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

namespace pcavr {

/// A box of a TsdfVolume: its blocks and those next to it, bit for bit as the whole volume has
/// them, if each frame is either integrated or counted. Frame: base. One writer; const members may
/// run concurrently. The same bytes for any number of threads.
class TsdfPart {
 public:
  /// `part` empty: all blocks.
  explicit TsdfPart(const TsdfOptions& options, const std::optional<BlockBox>& part = {});
  ~TsdfPart();
  TsdfPart(TsdfPart&&) noexcept;

  /// See TsdfVolume::integrate.
  IntegrationReport integrate(const DepthImage& depth, const ColorImage& color,
                              const MaskImage& is_dynamic, const CameraModel& camera,
                              const Pose& T_base_camera, Parallelism parallelism);
  /// Counts a frame that sees nothing of the part (frame_reach.hpp), in the place of integrate().
  void integrate_unseen();

  /// What the part owns of the mesh (TsdfVolume::extract_mesh).
  [[nodiscard]] SurfaceTile extract_tile(const SurfaceEvidence& evidence,
                                         Parallelism parallelism) const;

  [[nodiscard]] std::size_t block_count() const;

 private:
  struct Blocks;
  std::unique_ptr<Blocks> blocks_;
};

}  // namespace pcavr
