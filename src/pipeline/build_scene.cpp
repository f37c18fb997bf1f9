// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/build_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/core/median.hpp"
#include "pcavr/core/stage_clock.hpp"
#include "pcavr/reconstruction/cloud_filter.hpp"
#include "pcavr/reconstruction/depth_filter.hpp"
#include "pcavr/reconstruction/mesh_cleanup.hpp"
#include "pcavr/reconstruction/tsdf_volume.hpp"
#include "pcavr/scene/support_plane.hpp"

#include "follow_objects.hpp"
#include "scene_quality.hpp"
#include "survey.hpp"

namespace pcavr {
namespace {

/// What a headset carries at 72 Hz, and two coarser steps for what is far [triangles].
constexpr std::size_t kLevelOfDetailTriangles[] = {300'000, 75'000, 20'000};
/// The finest level may leave the surface by this share of a voxel, each further one by four times
/// the one before.
constexpr double kLevelOfDetailError = 0.5;

Error no_images_error(const Recording& recording) {
  return {.message = "the recording holds no frames",
          .file = recording.folder.string(),
          .mend =
              "a scene needs colour and depth images: rgb.txt and depth.txt with at least one "
              "pair within 20 ms"};
}

/// What the second pass gathers.
struct Fused {
  TsdfVolume volume;
  OccupancyMap occupancy;
  std::vector<std::vector<ObjectObservation>> tracks;  ///< by body
  Trajectory camera_trajectory;
};

Expected<Fused> fuse_static_scene(const Recording& recording,
                                  const std::vector<MovableBody>& bodies, const Survey& survey,
                                  const BuildOptions& options, const SurveyOptions& survey_options,
                                  const Observer& observer) {
  const CameraModel& camera = *recording.manifest.camera;
  Fused fused{
      .volume = TsdfVolume({.voxel_size = options.voxel_size, .depth_noise = options.depth_noise}),
      .occupancy = OccupancyMap(
          {.resolution = options.occupancy_resolution, .farthest = options.depth_noise.farthest}),
      .tracks = std::vector<std::vector<ObjectObservation>>(bodies.size()),
      .camera_trajectory = {}};
  const Expected<void> done = follow_objects(
      recording, bodies, survey, survey_options, observer, [&](const FollowedFrame& followed) {
        const DepthImage depth =
            filter_depth(followed.frame.depth, camera, options.depth_noise, options.parallelism);
        fused.volume.integrate(depth, followed.frame.color, followed.is_dynamic, camera,
                               followed.T_base_camera, options.parallelism);
        fused.occupancy.integrate(depth, followed.is_dynamic, camera, followed.T_base_camera);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
          fused.tracks[i].push_back(followed.objects[i]);
        }
        fused.camera_trajectory.append(followed.frame.depth_stamp, followed.T_base_camera);
      });
  if (!done) return done.error();
  return fused;
}

std::vector<TriangleMesh> levels_of_detail(const TriangleMesh& mesh, double voxel_size) {
  std::vector<TriangleMesh> levels;
  double largest_error = kLevelOfDetailError * voxel_size;
  for (const std::size_t triangles : kLevelOfDetailTriangles) {
    levels.push_back(simplified(levels.empty() ? mesh : levels.back(), triangles, largest_error));
    largest_error *= 4.0;
  }
  return levels;
}

/// The mesh's vertices are the registered cloud, averaged over all frames: one point a voxel.
PointCloud cloud_of(const TriangleMesh& mesh) {
  return remove_outliers({mesh.vertices, mesh.normals, mesh.colors});
}

SceneObject to_scene_object(const MovableBody& body, const std::vector<ObjectObservation>& track) {
  SceneObject object;
  object.model = body.model;
  object.evidence = kNotSeen;
  object.mass = body.entry.mass;
  object.is_movable = body.entry.is_movable;
  std::vector<double> translations;
  std::vector<double> rotations;
  const ObjectObservation* first = nullptr;
  const ObjectObservation* last = nullptr;
  bool still_at_start = true;
  for (const ObjectObservation& seen : track) {
    if (seen.evidence == ObjectEvidence::none) continue;
    // While it rests where it started, each observation knows that place better than the last.
    still_at_start = still_at_start && (seen.is_at_rest || first == nullptr || !first->is_at_rest);
    if (first == nullptr || (still_at_start && seen.is_at_rest)) first = &seen;
    last = &seen;
    translations.push_back(seen.refinement_translation);
    rotations.push_back(seen.refinement_rotation);
  }
  if (last == nullptr) {
    if (body.entry.T_base_object) {
      object.evidence = "manifest";
      object.T_base_object = object.T_base_object_start = *body.entry.T_base_object;
    }
    return object;
  }
  object.T_base_object_start = first->T_base_object;
  object.T_base_object = last->T_base_object;
  object.evidence = evidence_word(last->evidence);
  object.position_sigma = std::sqrt(last->covariance.topLeftCorner<3, 3>().trace());
  object.rotation_sigma = std::sqrt(last->covariance.bottomRightCorner<3, 3>().trace());
  object.refinement_translation = median(std::move(translations));
  object.refinement_rotation = median(std::move(rotations));
  return object;
}

std::vector<StandingBody> standing_bodies(const std::vector<SceneObject>& objects) {
  std::vector<StandingBody> bodies;
  for (const SceneObject& object : objects) {
    if (object.evidence == kNotSeen) continue;
    bodies.push_back({object.model.name, &object.model.mesh_object, object.T_base_object});
  }
  return bodies;
}

}  // namespace

Expected<Scene> build_scene(const Recording& recording, const BuildOptions& options,
                            const Observer& observer) {
  if (!recording.manifest.camera || recording.frames.empty()) return no_images_error(recording);
  StageClock clock;
  const SurveyOptions survey_options{.depth_noise = options.depth_noise,
                                     .trust_poses = options.trust_poses,
                                     .skip_bad = options.skip_bad,
                                     .parallelism = options.parallelism};

  // Registration: the tags, and the camera in base.
  clock.begin("tags and camera");
  const Expected<std::vector<MovableBody>> bodies = load_movable_bodies(recording);
  if (!bodies) return bodies.error();
  const Expected<Survey> survey = survey_recording(recording, *bodies, survey_options, observer);
  if (!survey) return survey.error();

  // Reconstruction: movable objects are followed and taken out, the rest is fused and meshed.
  clock.begin("objects and fusion");
  Expected<Fused> fused =
      fuse_static_scene(recording, *bodies, *survey, options, survey_options, observer);
  if (!fused) return fused.error();
  clock.begin("mesh");
  TriangleMesh mesh = fused->volume.extract_mesh(options.smallest_weight, options.parallelism);
  remove_small_islands(mesh, options.smallest_island);
  fused->occupancy.clear_unsupported(mesh);

  // Scene: what is displayed, and the CAD bodies where the markers say.
  clock.begin("levels of detail and cloud");
  Scene scene{.mesh_base = std::move(mesh),
              .levels_of_detail_base = {},
              .cloud_base = {},
              .occupancy = std::move(fused->occupancy),
              .support_planes = {},
              .objects = {},
              .camera_trajectory = std::move(fused->camera_trajectory),
              .quality = {},
              .recording = recording.folder.string(),
              .voxel_size = options.voxel_size};
  scene.levels_of_detail_base = levels_of_detail(scene.mesh_base, options.voxel_size);
  scene.cloud_base = cloud_of(scene.mesh_base);
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    scene.objects.push_back(to_scene_object((*bodies)[i], fused->tracks[i]));
  }
  clock.begin("support and quality");
  scene.support_planes = find_support_planes(scene.mesh_base, standing_bodies(scene.objects));
  scene.quality = assess_quality(recording, *survey, scene);
  clock.end();
  scene.quality.times = clock.times();
  return scene;
}

}  // namespace pcavr
