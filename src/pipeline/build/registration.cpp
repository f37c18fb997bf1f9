// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "registration.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "memory_need.hpp"

namespace pcavr {
namespace {

std::vector<std::optional<Pose>> found_poses(const Survey& survey) {
  std::vector<std::optional<Pose>> poses;
  for (const FramePlacement& frame : survey.camera.frames) {
    poses.resize(std::max(poses.size(), frame.frame + 1));
    if (frame.status == PlacementStatus::placed) poses[frame.frame] = frame.T_base_camera;
  }
  return poses;
}

std::size_t count_known(const std::vector<std::optional<Pose>>& poses) {
  return static_cast<std::size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); }));
}

}  // namespace

SurveyOptions survey_options(const BuildOptions& options) {
  return {.perception = options.perception,
          .trust_poses = options.trust_poses,
          .skip_bad = options.skip_bad,
          .parallelism = options.parallelism};
}

Expected<Registration> register_frames(const BuildLimits& limits, const Recording& recording,
                                       const BuildOptions& options, const Observer& observer,
                                       std::optional<Survey> known_survey) {
  Expected<std::vector<DeclaredBody>> bodies =
      load_movable_bodies(recording, options.perception.cad);
  if (!bodies) return bodies.error();
  Expected<std::vector<DeclaredBody>> immovable =
      load_immovable_bodies(recording, options.perception.cad);
  if (!immovable) return immovable.error();
  for (const auto* loaded : {&*bodies, &*immovable}) {
    for (const DeclaredBody& body : *loaded) report_simplified(body.model, observer);
  }
  // Before the long work where poses are stated, else before the fusion.
  const bool has_poses = !recording.groundtruth.empty() && !known_survey;
  if (has_poses) {
    if (const auto fits = check_memory(limits, recording, stated_poses(recording), options); !fits)
      return fits.error();
  }
  Expected<Survey> survey =
      known_survey ? *std::move(known_survey)
                   : survey_recording(recording, *bodies, survey_options(options), observer);
  if (!survey) return survey.error();
  const std::vector<std::optional<Pose>> found = found_poses(*survey);
  if (!has_poses || count_known(found) > count_known(stated_poses(recording))) {
    if (const auto fits = check_memory(limits, recording, found, options); !fits)
      return fits.error();
  }
  return Registration{*std::move(bodies), *std::move(immovable), *std::move(survey)};
}

}  // namespace pcavr
