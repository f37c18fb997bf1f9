// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/tile_steps.hpp"

#include "pcavr/base/core/check.hpp"

#include "registration.hpp"
#include "tile_files.hpp"
#include "tile_fusion.hpp"

namespace pcavr {

Expected<void> survey_tiles(const BuildLimits& limits, const Recording& recording,
                            const BuildOptions& options, const WriteContent& write,
                            const Observer& observer) {
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
  return write_tile_survey(collector.frames(), registration->survey, options, write);
}

Expected<void> fuse_tiles(const std::filesystem::path& survey_file, const TilePart& part,
                          const Recording& recording, const BuildOptions& options,
                          const WriteContent& write, const Observer& observer) {
  PCAVR_REQUIRE(part.number < part.count, part.number, part.count);
  const Expected<TileSurvey> survey = read_tile_survey(survey_file, recording, options);
  if (!survey) return survey.error();
  FusedPartWriter file(part, survey->digest, write);
  const Expected<bool> has_agreed_surface =
      fuse_part(survey->frames, part, recording, options, observer,
                [&](const FusedTile& tile) { return file.add(tile); });
  if (!has_agreed_surface) return has_agreed_surface.error();
  return file.finish(*has_agreed_surface);
}

}  // namespace pcavr
