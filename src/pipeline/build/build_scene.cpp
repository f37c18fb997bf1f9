// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/build_scene.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <optional>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/cloud_filter.hpp"
#include "pcavr/perception/reconstruction/depth_filter.hpp"
#include "pcavr/perception/reconstruction/measured_cloud.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"
#include "pcavr/perception/scene/support_plane.hpp"
#include "pcavr/perception/texture/view_selection.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

#include "follow_objects.hpp"
#include "pipeline/checks/assess_consistency.hpp"
#include "pipeline/checks/clock_checks.hpp"
#include "pipeline/checks/scene_upright.hpp"
#include "pipeline/replay/async_if_parallel.hpp"
#include "pipeline/robot/recorded_arm.hpp"
#include "scene_from_color.hpp"
#include "scene_from_manifest.hpp"
#include "scene_quality.hpp"
#include "scene_texture.hpp"
#include "survey.hpp"
#include "widen_stds.hpp"

namespace pcavr {
namespace {

/// Size that a headset renders at 72 Hz, and two coarser levels for distant views [triangles].
constexpr std::size_t kLevelOfDetailTriangles[] = {300'000, 75'000, 20'000};

TsdfOptions fusion_options(const BuildOptions& options) {
  TsdfOptions fusion = options.fusion;
  fusion.depth_noise = options.perception.depth_noise;
  return fusion;
}

OccupancyOptions occupancy_options(const BuildOptions& options) {
  OccupancyOptions occupancy = options.occupancy;
  occupancy.max_range = options.perception.depth_noise.max_depth;
  return occupancy;
}

/// The result of the second pass: the static scene, and the tracks of its bodies.
class Fusion {
 public:
  Fusion(const CameraModel& camera, std::size_t bodies, const BuildOptions& options)
      : volume(fusion_options(options)),
        occupancy(occupancy_options(options)),
        cloud(options.fusion.voxel_size, options.perception.depth_noise),
        tracks(bodies),
        views(options.texture),
        camera_(camera),
        options_(options),
        occupancy_interval_(std::llround(options.occupancy_interval * 1e9)) {}

  void add(const FollowedFrame& followed) {
    const Stamp stamp = followed.frame.depth_stamp;
    const DepthImage& raw = followed.frame.depth;
    // Colour is taken on the depth image's grid: finer colour does not improve the surface.
    const CameraModel camera = on_grid(camera_, raw.width(), raw.height());
    const bool is_one_grid = camera.width == camera_.width;
    const ColorImage coarse =
        is_one_grid ? ColorImage()
                    : color_on_grid(followed.frame.color, camera.width, camera.height);
    const ColorImage& color = is_one_grid ? followed.frame.color : coarse;
    const DepthImage depth =
        filter_depth(raw, camera, options_.perception.depth_noise, options_.parallelism);
    // Averaging runs in parallel with the fusion, because neither of them uses both cores fully.
    std::future<void> averaged = async_if_parallel(options_.parallelism, [&] {
      cloud.add(depth, color, followed.is_dynamic, camera, followed.T_base_camera);
    });
    std::future<void> carved;
    if (!last_carved_ || stamp - *last_carved_ >= occupancy_interval_) {
      last_carved_ = stamp;
      carved = async_if_parallel(options_.parallelism, [&] {
        occupancy.integrate(depth, followed.is_dynamic, camera, followed.T_base_camera);
      });
    }
    volume.integrate(depth, color, followed.is_dynamic, camera, followed.T_base_camera,
                     options_.parallelism);
    if (carved.valid()) carved.get();
    averaged.get();
    if (options_.texture.enabled) {
      views.add(followed.frame.index, stamp, followed.T_base_camera, followed.frame.color, raw,
                followed.is_dynamic);
    }
    for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].push_back(followed.objects[i]);
    camera_trajectory.append(stamp, followed.T_base_camera);
  }

  TsdfVolume volume;
  OccupancyMap occupancy;
  MeasuredCloud cloud;
  std::vector<std::vector<ObjectObservation>> tracks;  ///< by body
  Trajectory camera_trajectory;
  ViewSelection views;  ///< for the texture

 private:
  const CameraModel& camera_;  ///< of the colour images
  const BuildOptions& options_;
  Duration occupancy_interval_;
  std::optional<Stamp> last_carved_;
};

std::vector<TriangleMesh> levels_of_detail(const TriangleMesh& mesh, const BuildOptions& options) {
  std::vector<TriangleMesh> levels;
  double max_error = options.level_of_detail_error * options.fusion.voxel_size;
  for (const std::size_t triangles : kLevelOfDetailTriangles) {
    levels.push_back(simplified(levels.empty() ? mesh : levels.back(), triangles, max_error));
    max_error *= 4.0;
  }
  return levels;
}

/// Empty where no frames agree on a surface, whatever single frames measured.
TriangleMesh static_surface(const TsdfVolume& volume, const SurfaceEvidence& evidence,
                            const BuildOptions& options) {
  TriangleMesh mesh = volume.extract_mesh(options.min_weight, options.parallelism);
  remove_small_components(mesh, options.min_island);
  if (mesh.triangles.empty() || evidence.min_uncontradicted_weight >= options.min_weight)
    return mesh;
  mesh = volume.extract_mesh(evidence, options.parallelism);
  remove_small_components(mesh, options.min_island);
  return mesh;
}

/// Distance from the mesh within which measured points are of its surface [voxels]. Points farther
/// away are of things that moved, or outliers.
constexpr double kMaxMeshDistance = 2.0;

/// The registered cloud: the measured points of all frames, without those that are not of the
/// static surface.
PointCloud registered_cloud(const MeasuredCloud& measured, const TriangleMesh& mesh,
                            const SurfaceEvidence& evidence, const BuildOptions& options) {
  const PointCloud points =
      measured.points(static_cast<int>(std::ceil(evidence.min_uncontradicted_weight)));
  return remove_outliers(points_near(points, mesh, kMaxMeshDistance * options.fusion.voxel_size),
                         options.outliers);
}

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
  warn_of_clocks(recording, observer);
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
  const SurveyOptions survey_options{.perception = options.perception,
                                     .trust_poses = options.trust_poses,
                                     .skip_bad = options.skip_bad,
                                     .parallelism = options.parallelism};

  // Registration: tag detection and the camera's poses in base.
  clock.begin("tags and camera");
  const Expected<std::vector<DeclaredBody>> bodies =
      load_movable_bodies(recording, options.perception.cad);
  if (!bodies) return bodies.error();
  const Expected<std::vector<DeclaredBody>> immovable =
      load_immovable_bodies(recording, options.perception.cad);
  if (!immovable) return immovable.error();
  for (const auto* loaded : {&*bodies, &*immovable}) {
    for (const DeclaredBody& body : *loaded) report_simplified(body.model, observer);
  }
  const Expected<Survey> survey = survey_recording(recording, *bodies, survey_options, observer);
  if (!survey) return survey.error();

  // Reconstruction: movable objects are tracked and masked, the rest is fused and meshed (TSDF,
  // marching cubes).
  clock.begin("objects and fusion");
  Fusion fusion(*recording.manifest.camera, bodies->size(), options);
  const Expected<void> followed = follow_objects(
      recording, *bodies, *survey, survey_options, observer,
      [&](const FollowedFrame& frame) { fusion.add(frame); }, *arm ? &**arm : nullptr);
  if (!followed) return followed.error();
  clock.begin("mesh");
  const SurfaceEvidence evidence = surface_evidence(options, fusion.camera_trajectory.size());
  TriangleMesh mesh = static_surface(fusion.volume, evidence, options);
  if (mesh.triangles.empty()) {
    return empty_scene_error(recording, *survey, fusion.camera_trajectory, options);
  }
  fusion.occupancy.clear_unsupported(mesh);

  // Scene: the surfaces to display, and the CAD bodies at the poses from their markers.
  clock.begin("levels of detail and cloud");
  Scene scene{.mesh_base = std::move(mesh),
              .levels_of_detail_base = {},
              .cloud_base = {},
              .occupancy = std::move(fusion.occupancy),
              .support_planes = {},
              .objects = {},
              .robot = {},
              .tags = scene_tags(recording.manifest),
              .camera_trajectory = std::move(fusion.camera_trajectory),
              .quality = {},
              .recording = recording.folder.string(),
              .voxel_size = options.fusion.voxel_size};
  std::future<PointCloud> cloud = async_if_parallel(options.parallelism, [&] {
    return registered_cloud(fusion.cloud, scene.mesh_base, evidence, options);
  });
  scene.levels_of_detail_base = levels_of_detail(scene.mesh_base, options);
  scene.cloud_base = cloud.get();
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    scene.objects.push_back(scene_object_of_track((*bodies)[i], fusion.tracks[i]));
    report_not_found(recording, *survey, (*bodies)[i], options.perception.body_pose, observer,
                     scene.objects.back());
    widen_by_doubts(recording.manifest, *survey, i, scene.camera_trajectory, scene.objects.back());
    scene.objects.back().hertz_stiffness =
        hertz_stiffness_of(recording.manifest, (*bodies)[i].entry);
  }
  if (*arm) scene.robot = scene_robot_of(**arm);
  for (const DeclaredBody& body : *immovable) {
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
  scene.quality = assess_quality(recording, *survey, scene, options.max_surface_distance);
  if (inclined) {
    observer.on_warning(inclined->to_string());
    scene.quality.input_warnings.push_back(to_warning(*inclined));
  }
  for (const ConsistencyFinding& finding :
       rejected_tags(recording, *survey, scene.objects, options.perception.body_pose)) {
    observer.on_warning(finding.to_string());
    scene.quality.input_warnings.push_back(to_warning(finding));
  }
  clock.begin("texture");
  paint_scene(recording, std::move(fusion.views), options, scene);
  clock.end();
  scene.quality.times = clock.times();
  return scene;
}

}  // namespace pcavr
