// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "loaded_tip.hpp"
#include "pipeline/checks/clock_checks.hpp"
#include "pipeline/checks/consistency_checks.hpp"
#include "pipeline/checks/tracked_start.hpp"

namespace pcavr {
namespace {

/// Radius of the tip where a recording does not state it.
constexpr double kDefaultTipRadius = 0.01;  // [m] as in the recording format's example

Expected<std::vector<IdentifiableObject>> objects_of_scene(const SceneManifest& scene,
                                                           const Observer& observer) {
  for (const NotFoundObject& object : scene.not_found) {
    observer.on_warning(object.to_string() + "; it is not identified");
  }
  std::vector<IdentifiableObject> objects;
  for (const SceneObjectEntry& entry : scene.objects) {
    Expected<CadModel> model = read_object_model(scene, entry);
    if (!model) return model.error();
    objects.push_back({.name = entry.name,
                       .model = std::move(*model),
                       .T_base_object = entry.T_base_object_start,
                       .mass = entry.mass,
                       .is_movable = entry.is_movable});
  }
  return objects;
}

Expected<std::vector<IdentifiableObject>> objects_of_manifest(
    const Recording& recording, bool is_tracked, const ConsistencyOptions& consistency) {
  std::vector<IdentifiableObject> objects;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (entry.mesh.empty()) continue;
    if (!entry.T_base_object && !(is_tracked && entry.is_movable)) {
      return Error{.message = "has no pose for object " + entry.name,
                   .file = (recording.folder / "recording.yaml").string(),
                   .place = "objects",
                   .hint = "add its pose or its tracked poses, or give --scene or --tracked"};
    }
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, {}, entry.mesh_unit);
    if (!model) return model.error();
    const auto findings = check_body(recording.manifest, entry, *model,
                                     SurfaceQuery(model->mesh_object), consistency);
    if (has_contradiction(findings)) return contradiction_error(recording, findings);
    objects.push_back({.name = entry.name,
                       .model = std::move(*model),
                       .T_base_object = entry.T_base_object.value_or(Pose()),
                       .mass = entry.mass,
                       .is_movable = entry.is_movable});
  }
  return objects;
}

/// The scene's masses are used; the recording may know better.
void warn_of_other_masses(const Recording& recording, const SceneManifest& scene,
                          const Observer& observer) {
  constexpr double kSameMass = 0.01;  // relative
  for (const ObjectEntry& entry : recording.manifest.objects) {
    for (const SceneObjectEntry& known : scene.objects) {
      if (known.name != entry.name || !entry.mass || !known.mass) continue;
      if (std::abs(*entry.mass - *known.mass) <= kSameMass * *known.mass) continue;
      observer.on_warning(fmt::format(
          "{}: objects: {} has a mass of {:.4g} kg, and of {:.4g} kg in the scene, which is used: "
          "correct one of them",
          (recording.folder / "recording.yaml").string(), entry.name, *entry.mass, *known.mass));
    }
  }
}

bool has_movable(const std::vector<IdentifiableObject>& objects) {
  return std::any_of(objects.begin(), objects.end(),
                     [](const IdentifiableObject& object) { return object.is_movable; });
}

Expected<void> read_tracking(const Recording& recording, const std::filesystem::path& folder,
                             bool skip_bad, const Observer& observer, IdentificationInput& input) {
  bool has_any = false;
  for (IdentifiableObject& object : input.objects) {
    if (!object.is_movable) continue;
    Expected<TrackedFile> tracked =
        read_tracked_poses(folder, object.name,
                           {.zero = start_of(recording),
                            .skip_bad = skip_bad,
                            .T_tracked_object = tracked_to_object(recording, folder, object.name)});
    if (!tracked) return tracked.error();
    object.tracked = std::move(tracked->poses);
    if (tracked->note) input.notes.push_back(*tracked->note);
    std::move(tracked->left_out.begin(), tracked->left_out.end(),
              std::back_inserter(input.left_out));
    warn_of_tracked_clock(recording, object.name, object.tracked, start_of(recording), observer);
    has_any |= !object.tracked.empty();
  }
  if (!has_any && has_movable(input.objects)) {
    return Error{.message = "contains no objects/NAME/tracked.txt of any of the objects",
                 .file = folder.string(),
                 .hint = "give a run from pcavr replay"};
  }
  return {};
}

/// Compares where the tracks begin with the poses of the scene, or of recording.yaml without one.
Expected<void> check_tracks(const Recording& recording, const std::filesystem::path& folder,
                            bool has_scene, const std::vector<IdentifiableObject>& objects,
                            const Observer& observer) {
  std::vector<TrackedStart> starts;
  for (const IdentifiableObject& object : objects) {
    const bool is_stated =
        has_scene || std::any_of(recording.manifest.objects.begin(),
                                 recording.manifest.objects.end(), [&](const ObjectEntry& entry) {
                                   return entry.name == object.name && entry.T_base_object;
                                 });
    if (object.tracked.empty() || !is_stated) continue;
    starts.push_back({object.name, (folder / "objects" / object.name / "tracked.txt").string(),
                      object.T_base_object, object.tracked.front().T_base_object});
  }
  return accept_tracked_starts(starts, observer);
}

Expected<void> track_by_images(const Recording& recording, const IdentificationSources& sources,
                               const std::optional<SceneManifest>& scene, const Observer& observer,
                               IdentificationInput& input) {
  std::vector<IdentifiableObject>& objects = input.objects;
  if (!scene || recording.frames.empty() || !has_movable(objects)) return {};
  const Expected<Replay> replay = replay_tracking(recording, *scene,
                                                  {.perception = sources.perception,
                                                   .skip_bad = sources.skip_bad,
                                                   .parallelism = sources.parallelism},
                                                  observer);
  if (!replay) return replay.error();
  for (const auto& [reason, count] : replay->frames_dropped) {
    input.left_out.push_back({"frames", reason, count});
  }
  for (const ReplayedObject& replayed : replay->objects) {
    for (IdentifiableObject& object : objects) {
      if (object.name == replayed.name) {
        object.tracked = tracked_poses_of(replayed.observations, start_of(recording));
      }
    }
  }
  return {};
}

}  // namespace

Expected<IdentificationInput> identification_input(const Recording& recording,
                                                   const IdentificationSources& sources,
                                                   const Observer& observer) {
  IdentificationInput input;
  input.left_out = recording.left_out;
  input.notes = recording.notes;
  input.tool_radius = recording.manifest.tool_radius.value_or(kDefaultTipRadius);
  input.force_direction_std = recording.manifest.force_direction_std.value_or(0.0);
  const Stamp start = start_of(recording);
  for (const auto& [stamp, pose] : recording.tool.poses()) {
    input.t_tool.push_back(to_seconds(stamp - start));
    input.p_base_tip.push_back(pose.translation());
    input.q_base_tool.push_back(pose.rotation());
  }
  Expected<std::vector<Eigen::Matrix3d>> covariance =
      tip_covariance(recording, sources.perception.loaded_tip);
  if (!covariance) return covariance.error();
  input.tip_covariance_base = std::move(*covariance);
  for (const WrenchSample& sample : recording.wrench) {
    input.t_force.push_back(to_seconds(sample.stamp - start));
    input.force_base.push_back(sample.force);
  }
  // Tracking takes long: missing inputs are reported first.
  const auto tracked = tracked_folder_of(
      recording, sources.tracked.empty() ? std::nullopt : std::optional(sources.tracked));
  const bool is_tracked_in_images = !sources.scene.empty() && !tracked;
  const auto conflict =
      check_clocks(recording, is_tracked_in_images ? ImageUse::tracking : ImageUse::none, observer);
  if (conflict) return *conflict;
  if (auto slow = check_rates(recording)) return *slow;
  if (auto error = missing_streams(input)) {
    error->file = (recording.folder / error->file).string();
    return *error;
  }
  std::optional<SceneManifest> scene;
  if (!sources.scene.empty()) {
    Expected<SceneManifest> manifest = read_scene_manifest(sources.scene);
    if (!manifest) return manifest.error();
    scene = std::move(*manifest);
  }
  if (scene) warn_of_other_masses(recording, *scene, observer);
  Expected<std::vector<IdentifiableObject>> objects =
      scene ? objects_of_scene(*scene, observer)
            : objects_of_manifest(recording, tracked.has_value(), sources.perception.consistency);
  if (!objects) return objects.error();
  input.objects = std::move(*objects);
  const Expected<void> done =
      tracked ? read_tracking(recording, *tracked, sources.skip_bad, observer, input)
              : track_by_images(recording, sources, scene, observer, input);
  if (!done) return done.error();
  if (tracked) {
    const Expected<void> accepted =
        check_tracks(recording, *tracked, scene.has_value(), input.objects, observer);
    if (!accepted) return accepted.error();
  }
  return input;
}

}  // namespace pcavr
