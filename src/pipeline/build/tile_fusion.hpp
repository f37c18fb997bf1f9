// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/reconstruction/frame_reach.hpp"
#include "pcavr/perception/reconstruction/surface_tiles.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/pipeline/tile_steps.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "follow_objects.hpp"
#include "fused_frame.hpp"

namespace pcavr {

/// A frame with all that its fusion needs besides its images.
struct PlacedFrame {
  std::size_t index = 0;  ///< in Recording::frames
  Pose T_base_camera;
  std::vector<ObjectObservation> objects;  ///< in the order of the bodies
  PackedMask is_dynamic;
  FrameReach reach;
};

/// The frames of a scene that is fused by tiles.
struct TileFrames {
  std::string recording = {};  ///< recording_digest() of it
  double tile_size = 0.0;      ///< edge of a square, seen from above [m]
  int width = 0;               ///< of the depth images [px]; 0 without frames
  int height = 0;
  std::vector<PlacedFrame> frames = {};
};

/// The SHA-256 of what a survey depends on: manifest, stated poses, meshes, and the names and
/// stamps of the frames, not their pixels.
[[nodiscard]] std::string recording_digest(const Recording& recording);

/// Collects them.
class TileFrameCollector {
 public:
  /// `recording` has a camera, that of the colour images. Keeps references to it and to `options`.
  TileFrameCollector(double tile_size, const Recording& recording, const BuildOptions& options);

  void add(const FollowedFrame& frame);
  [[nodiscard]] const TileFrames& frames() const { return frames_; }

 private:
  const CameraModel& camera_;
  const BuildOptions& options_;
  TileFrames frames_;
  std::optional<ReachFinder> finder_;  ///< from the first frame on
};

/// What one tile has of the scene.
struct FusedTile {
  std::size_t number = 0;
  SurfaceTile surface = {};
  std::optional<SurfaceTile> strict = {};  ///< by min_weight
  PointCloud points = {};                  ///< [base]
};

/// Tiles of a scene, by their numbers.
struct FusedTiles {
  std::vector<FusedTile> tiles = {};  ///< without those that have no surface
  /// Whether enough frames agree on a surface in one of them; then none of its `strict` is used.
  bool has_agreed_surface = false;

  /// A tile without `strict` shows that those of the others are not needed.
  void add(FusedTile tile);
};

/// Fuses the tiles of one part, every `part.count`-th one, one after the other, from the frames
/// that see it, which are decoded again. Calls `use` for each that has a surface, until one fails.
/// Returns whether enough frames agree on a surface in one of them: from that one on, or where the
/// evidence is not weaker than min_weight anyway, tiles have no `strict`.
[[nodiscard]] Expected<bool> fuse_part(const TileFrames& frames, const TilePart& part,
                                       const Recording& recording, const BuildOptions& options,
                                       const Observer& observer,
                                       const std::function<Expected<void>(FusedTile)>& use);

/// The frames of a survey once more, as follow_objects() had them: decodes their images, and calls
/// `use` for each in order, while the next one is prefetched on a second thread.
[[nodiscard]] Expected<void> repeat_frames(const TileFrames& frames, const Recording& recording,
                                           const BuildOptions& options, const Observer& observer,
                                           const std::function<void(const FollowedFrame&)>& use);

/// The surface of all tiles without islands, which are taken, and their points by tile. Empty where
/// no frames agree on a surface.
[[nodiscard]] std::pair<TriangleMesh, std::vector<PointCloud>> merge_tiles(
    FusedTiles fused, const BuildOptions& options);

/// The edge of a tile in blocks of the volume.
[[nodiscard]] int tile_blocks(double tile_size, const BuildOptions& options);

}  // namespace pcavr
