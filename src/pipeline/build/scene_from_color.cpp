// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_from_color.hpp"

#include <cstddef>
#include <vector>

#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

#include "follow_objects.hpp"
#include "scene_from_manifest.hpp"
#include "scene_quality.hpp"
#include "survey.hpp"

namespace pcavr {
namespace {

using Tracks = std::vector<std::vector<ObjectObservation>>;  // by body

/// Tracks of the bodies by their tags.
Expected<Tracks> follow(const Recording& recording, const std::vector<DeclaredBody>& bodies,
                        const Survey& survey, const SurveyOptions& options,
                        const Observer& observer) {
  Tracks tracks(bodies.size());
  const Expected<void> done =
      follow_objects(recording, bodies, survey, options, observer, [&](const FollowedFrame& frame) {
        for (std::size_t i = 0; i < bodies.size(); ++i) tracks[i].push_back(frame.objects[i]);
      });
  if (!done) return done.error();
  return tracks;
}

}  // namespace

Expected<Scene> scene_from_color(const Recording& recording, const BuildOptions& options,
                                 const Observer& observer) {
  observer.on_warning(
      "no depth.txt: camera and objects are placed by their tags, and no surfaces are "
      "reconstructed");
  StageClock clock;
  clock.begin("tags and camera");
  const SurveyOptions survey_options{.perception = options.perception,
                                     .trust_poses = options.trust_poses,
                                     .skip_bad = options.skip_bad,
                                     .parallelism = options.parallelism};
  const auto bodies = load_movable_bodies(recording, options.perception.cad);
  if (!bodies) return bodies.error();
  const auto immovable = load_immovable_bodies(recording, options.perception.cad);
  if (!immovable) return immovable.error();
  const Expected<Survey> survey = survey_recording(recording, *bodies, survey_options, observer);
  if (!survey) return survey.error();
  clock.begin("objects");
  const Expected<Tracks> tracks = follow(recording, *bodies, *survey, survey_options, observer);
  if (!tracks) return tracks.error();
  OccupancyOptions occupancy = options.occupancy;
  occupancy.max_range = options.perception.depth_noise.max_depth;
  Scene scene = empty_scene(recording, options.fusion.voxel_size, occupancy);
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    scene.objects.push_back(scene_object_of_track((*bodies)[i], (*tracks)[i]));
    report_not_found(recording, *survey, (*bodies)[i], options.perception.body_pose, observer,
                     scene.objects.back());
    scene.objects.back().hertz_stiffness =
        hertz_stiffness_of(recording.manifest, (*bodies)[i].entry);
  }
  for (const DeclaredBody& body : *immovable) {
    add_at_stated_pose(recording.manifest, body, scene);
  }
  scene.support_planes = horizontal_planes(scene.objects, recording.tool);
  // No frame is part of the scene: whoever replays a recording places its camera anew.
  scene.quality = assess_quality(recording, *survey, scene, options.max_surface_distance);
  clock.end();
  scene.quality.times = clock.times();
  return scene;
}

}  // namespace pcavr
