// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/pipeline/build_limits.hpp"

#include "follow_objects.hpp"
#include "fused_frame.hpp"

namespace pcavr {

/// Makes the static surface of a scene from frames with poses and masks: at once, or by tiles.
class SurfaceBuilder {
 public:
  virtual ~SurfaceBuilder() = default;

  /// Whether add() uses `fused`, which may be empty otherwise.
  [[nodiscard]] virtual bool needs_fused() const = 0;
  virtual void add(const FollowedFrame& frame, const FusedFrame& fused) = 0;

  /// After all frames: the surface, empty where no frames agree on one, whatever single frames
  /// measured. Call once.
  [[nodiscard]] virtual Expected<TriangleMesh> mesh(const SurfaceEvidence& evidence,
                                                    const Observer& observer) = 0;
  /// The registered cloud: the measured points of all frames, without those that are not of the
  /// mesh. Call once, after mesh().
  [[nodiscard]] virtual PointCloud cloud(const TriangleMesh& mesh_base,
                                         const SurfaceEvidence& evidence) = 0;
  [[nodiscard]] virtual std::vector<TriangleMesh> levels_of_detail(
      const TriangleMesh& mesh_base) const = 0;
};

/// Keeps references to its arguments.
[[nodiscard]] std::unique_ptr<SurfaceBuilder> make_whole_surface(const BuildOptions& options);
/// The same surface with the memory of one square of `limits.tile_size` after the other, from the
/// frames that see it, which are decoded again; or of the files in `limits.fused`.
[[nodiscard]] std::unique_ptr<SurfaceBuilder> make_tiled_surface(const BuildLimits& limits,
                                                                 const Recording& recording,
                                                                 const BuildOptions& options);

}  // namespace pcavr
