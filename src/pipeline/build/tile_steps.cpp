// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/tile_steps.hpp"

#include "pcavr/base/core/check.hpp"

#include "registration.hpp"
#include "tile_files.hpp"
#include "tile_fusion.hpp"

namespace pcavr {

Expected<std::string> survey_tiles(const BuildLimits& limits, const Recording& recording,
                                   const BuildOptions& options, const Observer& observer) {
  PCAVR_REQUIRE(limits.tile_size.has_value());
  if (!recording.manifest.camera || recording.frames.empty() || !recording.has_depth) {
    return Error{.message = "has no depth images, and so no tiles",
                 .file = recording.folder.string(),
                 .place = {},
                 .hint = "build it without --tiles"};
  }
  const Expected<std::optional<RecordedArm>> arm = read_recorded_arm(recording, observer);
  if (!arm) return arm.error();
  const Expected<Registration> registration = register_frames(limits, recording, options, observer);
  if (!registration) return registration.error();
  TileFrameCollector collector(*limits.tile_size, recording, options);
  const Expected<void> followed = follow_objects(
      recording, registration->bodies, registration->survey, survey_options(options), observer,
      [&](const FollowedFrame& frame) { collector.add(frame); }, *arm ? &**arm : nullptr);
  if (!followed) return followed.error();
  return format_tile_frames(collector.frames(), options);
}

Expected<std::string> fuse_tiles(const std::filesystem::path& frames_file, const TilePart& part,
                                 const Recording& recording, const BuildOptions& options,
                                 const Observer& observer) {
  PCAVR_REQUIRE(part.number < part.count, part.number, part.count);
  const Expected<TileFrames> frames = read_tile_frames(frames_file, options);
  if (!frames) return frames.error();
  if (!recording.manifest.camera || frames->recording != frames_digest(recording)) {
    return Error{.message = "is of another recording",
                 .file = frames_file.string(),
                 .place = {},
                 .hint = "run survey of " + recording.folder.string()};
  }
  const Expected<FusedTiles> fused = fuse_part(*frames, part, recording, options, observer);
  if (!fused) return fused.error();
  return format_fused_part(*fused, part, digest_of(format_tile_frames(*frames, options)));
}

}  // namespace pcavr
