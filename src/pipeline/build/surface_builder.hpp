// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "follow_objects.hpp"
#include "fused_frame.hpp"

namespace pcavr {

class FusedParts;  // tile_files.hpp

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
/// The same surface with the memory of one square of `tile_size` [m] after the other, from the
/// frames that see it, which are decoded again.
[[nodiscard]] std::unique_ptr<SurfaceBuilder> make_tiled_surface(double tile_size,
                                                                 const Recording& recording,
                                                                 const BuildOptions& options);
/// The same of such squares that other processes fused.
[[nodiscard]] std::unique_ptr<SurfaceBuilder> make_fused_surface(double tile_size, FusedParts parts,
                                                                 const BuildOptions& options);

}  // namespace pcavr
