// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_bodies.hpp"

#include <iterator>
#include <string>
#include <utility>

#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

namespace pcavr {
namespace {

/// Pose of a body as the recording begins. The scene states its pose as the scene's own recording
/// began: another recording, without images to find it, states the pose itself.
Pose T_base_object_at_start(const Recording& recording, const SceneManifest& scene,
                            const SceneObjectEntry& object) {
  if (scene.is_scanned() && recording.frames.empty()) {
    for (const ObjectEntry& stated : recording.manifest.objects) {
      if (stated.name == object.name && stated.T_base_object) return *stated.T_base_object;
    }
  }
  return object.T_base_object_start;
}

/// The scene's bodies, movable or not, at their initial poses, with the recording's tags.
Expected<std::vector<DeclaredBody>> bodies_of(const Recording& recording,
                                              const SceneManifest& scene, bool is_movable) {
  std::vector<DeclaredBody> bodies;
  for (const SceneObjectEntry& object : scene.objects) {
    if (object.is_movable != is_movable) continue;
    Expected<CadModel> model = read_object_model(scene, object);
    if (!model) return model.error();
    ObjectEntry entry{.name = object.name,
                      .mesh = object.mesh,
                      .mass = object.mass,
                      .is_movable = is_movable,
                      .T_base_object = T_base_object_at_start(recording, scene, object)};
    bodies.push_back(
        {std::move(entry), std::move(*model), object_placements(recording.manifest, object.name)});
  }
  return bodies;
}

void report_not_found(const SceneManifest& scene, const Observer& observer) {
  for (const NotFoundObject& object : scene.not_found) observer.on_warning(object.to_string());
}

Error no_object(const SceneManifest& scene, const char* what) {
  std::string message = std::string("the scene has no ") + what;
  for (const NotFoundObject& object : scene.not_found) message += "; " + object.to_string();
  return {.message = std::move(message),
          .file = (scene.folder / "scene.yaml").string(),
          .hint = "declare objects with mesh and pose or tags in recording.yaml, and build again"};
}

}  // namespace

Expected<SceneBodies> read_scene_bodies(const Recording& recording, const SceneManifest& scene,
                                        const ReplayOptions& options, const Observer& observer) {
  report_not_found(scene, observer);
  Expected<std::vector<DeclaredBody>> bodies = bodies_of(recording, scene, true);
  if (!bodies) return bodies.error();
  for (const DeclaredBody& body : *bodies) report_simplified(body.model, observer);
  Expected<ParameterTable> known =
      known_parameters(scene, options.parameters, options.parameters_file);
  if (!known) return known.error();
  Expected<std::vector<DeclaredBody>> immovable = bodies_of(recording, scene, false);
  if (!immovable) return immovable.error();
  for (const DeclaredBody& body : *immovable) report_simplified(body.model, observer);
  if (bodies->empty() && immovable->empty()) return no_object(scene, "object");
  return SceneBodies{std::move(*bodies), std::move(*immovable), std::move(*known)};
}

Expected<std::vector<DeclaredBody>> read_movable_bodies(const Recording& recording,
                                                        const SceneManifest& scene) {
  Expected<std::vector<DeclaredBody>> bodies = bodies_of(recording, scene, true);
  if (bodies && bodies->empty()) return no_object(scene, "movable object to track");
  return bodies;
}

std::vector<DeclaredBody> all_of(SceneBodies&& bodies) {
  std::vector<DeclaredBody> all = std::move(bodies.movable);
  std::move(bodies.immovable.begin(), bodies.immovable.end(), std::back_inserter(all));
  return all;
}

}  // namespace pcavr
