// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_from_color.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "pcavr/core/stage_clock.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

#include "follow_objects.hpp"
#include "scene_from_manifest.hpp"
#include "scene_quality.hpp"
#include "survey.hpp"

namespace pcavr {
namespace {

/// What tags show of the bodies and the camera.
struct Seen {
  std::vector<std::vector<ObjectObservation>> tracks;  ///< by body
  Trajectory camera;
};

Expected<Seen> follow(const Recording& recording, const std::vector<MovableBody>& bodies,
                      const Survey& survey, const SurveyOptions& options,
                      const Observer& observer) {
  Seen seen;
  seen.tracks.resize(bodies.size());
  const Expected<void> done =
      follow_objects(recording, bodies, survey, options, observer, [&](const FollowedFrame& frame) {
        for (std::size_t i = 0; i < bodies.size(); ++i) seen.tracks[i].push_back(frame.objects[i]);
        seen.camera.append(frame.frame.depth_stamp, frame.T_base_camera);
      });
  if (!done) return done.error();
  return seen;
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
  Expected<Seen> seen = follow(recording, *bodies, *survey, survey_options, observer);
  if (!seen) return seen.error();
  OccupancyOptions occupancy = options.occupancy;
  occupancy.max_range = options.perception.depth_noise.max_depth;
  Scene scene{.mesh_base = {},
              .levels_of_detail_base = {},
              .cloud_base = {},
              .occupancy = OccupancyMap(occupancy),
              .support_planes = {},
              .objects = {},
              .robot = {},
              .tags = scene_tags(recording.manifest),
              .camera_trajectory = std::move(seen->camera),
              .quality = {},
              .recording = recording.folder.string(),
              .voxel_size = options.fusion.voxel_size};
  scene.levels_of_detail_base.push_back(scene.mesh_base);
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    scene.objects.push_back(scene_object_of_track((*bodies)[i], seen->tracks[i]));
    scene.objects.back().hertz_stiffness =
        hertz_stiffness_of(recording.manifest, (*bodies)[i].entry);
  }
  for (const MovableBody& body : *immovable) {
    scene.objects.push_back(scene_object_at_stated_pose(body));
    scene.objects.back().hertz_stiffness = hertz_stiffness_of(recording.manifest, body.entry);
    scene.occupancy.mark_occupied(
        transformed(body.entry.T_base_object.value(), body.model.mesh_object));
  }
  scene.support_planes = horizontal_planes(scene.objects, recording.tool);
  scene.quality = assess_quality(recording, *survey, scene, options.max_surface_distance);
  // No frame is part of the scene: whoever replays a recording places its camera anew.
  scene.quality.frames_used = 0;
  scene.camera_trajectory = {};
  clock.end();
  scene.quality.times = clock.times();
  return scene;
}

}  // namespace pcavr
