// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/perception/scene/support_plane.hpp"
#include "pcavr/perception/texture/view_selection.hpp"
#include "pcavr/pipeline/build_limits.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

#include "follow_objects.hpp"
#include "pipeline/checks/assess_consistency.hpp"
#include "pipeline/checks/clock_checks.hpp"
#include "pipeline/checks/scene_upright.hpp"
#include "pipeline/replay/async_if_parallel.hpp"
#include "pipeline/robot/recorded_arm.hpp"
#include "registration.hpp"
#include "scene_from_color.hpp"
#include "scene_from_manifest.hpp"
#include "scene_quality.hpp"
#include "scene_texture.hpp"
#include "surface_builder.hpp"
#include "survey.hpp"
#include "tile_files.hpp"
#include "tile_fusion.hpp"
#include "widen_stds.hpp"

namespace pcavr {
namespace {

OccupancyOptions occupancy_options(const BuildOptions& options) {
  OccupancyOptions occupancy = options.occupancy;
  occupancy.max_range = options.perception.depth_noise.max_depth;
  return occupancy;
}

/// What the second pass yields: the static scene, and the tracks of its bodies.
class SecondPass {
 public:
  SecondPass(std::unique_ptr<SurfaceBuilder> builder, const Recording& recording,
             std::size_t bodies, const BuildOptions& options)
      : surface(std::move(builder)),
        occupancy(occupancy_options(options)),
        tracks(bodies),
        views(options.texture),
        camera_(*recording.manifest.camera),
        options_(options),
        occupancy_interval_(std::llround(options.occupancy_interval * 1e9)) {}

  void add(const FollowedFrame& followed) {
    const Stamp stamp = followed.frame.depth_stamp;
    const bool carves = !last_carved_ || stamp - *last_carved_ >= occupancy_interval_;
    FusedFrame fused;
    if (carves || surface->needs_fused()) fused = fused_frame(followed.frame, camera_, options_);
    std::future<void> carved;
    if (carves) {
      last_carved_ = stamp;
      carved = async_if_parallel(options_.parallelism, [&] {
        occupancy.integrate(fused.depth, followed.is_dynamic, fused.camera, followed.T_base_camera);
      });
    }
    surface->add(followed, fused);
    if (carved.valid()) carved.get();
    if (options_.texture.enabled) {
      views.add(followed.frame.index, stamp, followed.T_base_camera, followed.frame.color,
                followed.frame.depth, followed.is_dynamic);
    }
    for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].push_back(followed.objects[i]);
    camera_trajectory.append(stamp, followed.T_base_camera);
  }

  std::unique_ptr<SurfaceBuilder> surface;
  OccupancyMap occupancy;
  std::vector<std::vector<ObjectObservation>> tracks;  ///< by body
  Trajectory camera_trajectory;
  ViewSelection views;  ///< for the texture

 private:
  const CameraModel& camera_;  ///< of the colour images
  const BuildOptions& options_;
  Duration occupancy_interval_;
  std::optional<Stamp> last_carved_;
};

std::vector<SupportedBody> standing_bodies(const std::vector<SceneObject>& objects) {
  std::vector<SupportedBody> bodies;
  for (const SceneObject& object : objects) {
    if (object.evidence == kNotSeen || !object.is_movable) continue;
    bodies.push_back({object.model.name, &object.model.mesh_object, object.T_base_object});
  }
  return bodies;
}

/// Median motion of the camera from frame to frame.
CameraSteps steps_of(const Trajectory& camera) {
  std::vector<double> translations;
  std::vector<double> rotations;
  for (std::size_t i = 1; i < camera.size(); ++i) {
    const Pose& before = camera.poses()[i - 1].pose;
    const Pose& after = camera.poses()[i].pose;
    translations.push_back(translation_distance(before, after));
    rotations.push_back(rotation_distance(before, after));
  }
  return {camera.size(), median(std::move(translations)), median(std::move(rotations))};
}

Error empty_scene_error(const Recording& recording, const Survey& survey, const Trajectory& camera,
                        const BuildOptions& options) {
  const EmptySceneCause cause =
      explain_empty_scene(survey.depth, options.perception.depth_noise,
                          recording.manifest.depth_scale, steps_of(camera), options.min_weight);
  return {.message = "the frames yield no surface: " + cause.message,
          .file = recording.folder.string(),
          .hint = cause.hint};
}

/// What other processes have of a build by tiles.
struct EarlierSteps {
  TileSurvey placed;
  FusedParts parts;
};

/// Empty where this process does all. Checked before the long work.
Expected<std::optional<EarlierSteps>> open_earlier_steps(const BuildLimits& limits,
                                                         const Recording& recording,
                                                         const BuildOptions& options) {
  PCAVR_REQUIRE(limits.survey.empty() == limits.fused.empty(), limits.survey.string());
  if (limits.survey.empty()) return std::optional<EarlierSteps>();
  Expected<TileSurvey> placed = read_tile_survey(limits.survey, recording, options);
  if (!placed) return placed.error();
  Expected<FusedParts> parts = FusedParts::open(limits.fused, placed->digest);
  if (!parts) return parts.error();
  return std::optional(EarlierSteps{*std::move(placed), *std::move(parts)});
}

std::unique_ptr<SurfaceBuilder> make_surface(const BuildLimits& limits, const Recording& recording,
                                             const BuildOptions& options,
                                             std::optional<EarlierSteps>& earlier) {
  if (earlier) {
    return make_fused_surface(earlier->placed.frames.tile_size, std::move(earlier->parts), options);
  }
  if (limits.tile_size) return make_tiled_surface(*limits.tile_size, recording, options);
  return make_whole_surface(options);
}

/// Objects at the manifest's pose although their tags were detected.
std::vector<ConsistencyFinding> rejected_tags(const Recording& recording, const Survey& survey,
                                              const std::vector<SceneObject>& objects,
                                              const BodyPoseOptions& options) {
  std::vector<ConsistencyFinding> findings;
  for (const SceneObject& object : objects) {
    if (object.evidence != kByManifest) continue;  // others: report_not_found
    const std::string reason =
        explain_rejected_tags(recording, survey.detections, object.model.name, options);
    if (reason.empty()) continue;
    findings.push_back({.file = "recording.yaml",
                        .place = "markers",
                        .message = object.model.name + " has no pose: " + reason,
                        .hint = kRejectedTagsHint});
  }
  return findings;
}

}  // namespace

Expected<Scene> build_scene(const Recording& recording, const BuildOptions& options,
                            const Observer& observer) {
  return build_scene_within({}, recording, options, observer);
}

Expected<Scene> build_scene_within(const BuildLimits& limits, const Recording& recording,
                                   const BuildOptions& options, const Observer& observer) {
  warn_of_clocks(recording, observer);
  Expected<std::optional<EarlierSteps>> earlier = open_earlier_steps(limits, recording, options);
  if (!earlier) return earlier.error();
  const Expected<std::optional<RecordedArm>> arm = read_recorded_arm(recording, observer);
  if (!arm) return arm.error();
  if (!recording.manifest.camera || recording.frames.empty()) {
    Expected<Scene> scene = scene_from_manifest(recording, options.fusion.voxel_size,
                                                occupancy_options(options), options.perception);
    if (scene) {
      if (*arm) scene->robot = scene_robot_of(**arm);
      for (const SceneObject& object : scene->objects) report_simplified(object.model, observer);
      observer.on_warning(
          "no images: the scene has the manifest's bodies only, and no reconstructed surfaces");
    }
    return scene;
  }
  if (!recording.has_depth) {
    Expected<Scene> scene = scene_from_color(recording, options, observer);
    if (scene && *arm) scene->robot = scene_robot_of(**arm);
    return scene;
  }
  StageClock clock;
  // Registration: tag detection and the camera's poses in base.
  clock.begin("tags and camera");
  BuildLimits with_tiles = limits;
  if (*earlier) with_tiles.tile_size = (*earlier)->placed.frames.tile_size;
  const Expected<Registration> registration = register_frames(
      with_tiles, recording, options, observer,
      *earlier ? std::optional(std::move((*earlier)->placed.survey)) : std::nullopt);
  if (!registration) return registration.error();
  const auto& [bodies, immovable, survey] = *registration;

  // Reconstruction: movable objects are tracked and masked, the rest is fused and meshed (TSDF,
  // marching cubes).
  clock.begin("objects and fusion");
  SecondPass pass(make_surface(limits, recording, options, *earlier), recording, bodies.size(),
                  options);
  const auto add = [&](const FollowedFrame& frame) { pass.add(frame); };
  const Expected<void> followed =
      *earlier ? repeat_frames((*earlier)->placed.frames, recording, options, observer, add)
               : follow_objects(recording, bodies, survey, survey_options(options), observer, add,
                                *arm ? &**arm : nullptr);
  if (!followed) return followed.error();
  clock.begin("mesh");
  const SurfaceEvidence evidence = surface_evidence(options, pass.camera_trajectory.size());
  Expected<TriangleMesh> mesh = pass.surface->mesh(evidence, observer);
  if (!mesh) return mesh.error();
  if (mesh->triangles.empty()) {
    return empty_scene_error(recording, survey, pass.camera_trajectory, options);
  }
  pass.occupancy.clear_unsupported(*mesh);

  // Scene: the surfaces to display, and the CAD bodies at the poses from their markers.
  clock.begin("levels of detail and cloud");
  Scene scene{.mesh_base = *std::move(mesh),
              .levels_of_detail_base = {},
              .cloud_base = {},
              .occupancy = std::move(pass.occupancy),
              .support_planes = {},
              .objects = {},
              .robot = {},
              .tags = scene_tags(recording.manifest),
              .camera_trajectory = std::move(pass.camera_trajectory),
              .quality = {},
              .recording = recording.folder.string(),
              .voxel_size = options.fusion.voxel_size};
  std::future<PointCloud> cloud = async_if_parallel(
      options.parallelism, [&] { return pass.surface->cloud(scene.mesh_base, evidence); });
  scene.levels_of_detail_base = pass.surface->levels_of_detail(scene.mesh_base);
  scene.cloud_base = cloud.get();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    scene.objects.push_back(scene_object_of_track(bodies[i], pass.tracks[i]));
    report_not_found(recording, survey, bodies[i], options.perception.body_pose, observer,
                     scene.objects.back());
    widen_by_doubts(recording.manifest, survey, i, scene.camera_trajectory, scene.objects.back());
    scene.objects.back().hertz_stiffness = hertz_stiffness_of(recording.manifest, bodies[i].entry);
  }
  if (*arm) scene.robot = scene_robot_of(**arm);
  for (const DeclaredBody& body : immovable) {
    scene.objects.push_back(scene_object_at_stated_pose(body));
    scene.objects.back().hertz_stiffness = hertz_stiffness_of(recording.manifest, body.entry);
  }
  clock.begin("support and quality");
  scene.support_planes =
      find_support_planes(scene.mesh_base, standing_bodies(scene.objects), options.support_planes);
  const auto inclined = check_upright(recording.manifest, scene);
  if (inclined && inclined->severity == FindingSeverity::contradiction) {
    return contradiction_error(recording, {*inclined});
  }
  scene.quality = assess_quality(recording, survey, scene, options.max_surface_distance);
  if (inclined) {
    observer.on_warning(inclined->to_string());
    scene.quality.input_warnings.push_back(to_warning(*inclined));
  }
  for (const ConsistencyFinding& finding :
       rejected_tags(recording, survey, scene.objects, options.perception.body_pose)) {
    observer.on_warning(finding.to_string());
    scene.quality.input_warnings.push_back(to_warning(finding));
  }
  clock.begin("texture");
  paint_scene(recording, std::move(pass.views), pass.tracks, options, scene);
  clock.end();
  scene.quality.times = clock.times();
  return scene;
}

}  // namespace pcavr
