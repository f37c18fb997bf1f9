// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges of all options of this module: src/serve/options.cpp.
struct SceneWorldOptions {
  SceneWorldOptions();
  std::optional<ParameterTable> parameters;  ///< as written by `pcavr identify`
  std::string parameters_file;               ///< file name for error messages
  double tool_radius;                        ///< [m] > 0
  double start_clearance;                    ///< [m] > 0 of the tool beside a movable object
  double start_height;                       ///< [m] of the tool above the movable objects
  int max_triangles;                         ///< of the mesh that is used for contact
  double max_shown_force;                    ///< [N] limit of the force where no device renders it
  double min_full_scale_force;               ///< [N] see SceneWorld::full_scale_force
  ForceOptions force;
  HapticWorldOptions haptics;
  WorldOptions world;
  PhysicsDefaults unknown_objects;
};
/// The section without `force`, `haptics`, `world` and `unknown_objects`, which have their own.
[[nodiscard]] OptionSection section_of(SceneWorldOptions& options);

/// A body's parameters that neither the scene nor identification gave, so that defaults are used
/// (see complete_physics).
struct AssumedParameters {
  std::string object;
  std::vector<std::string> names;  ///< empty: all are known
};

struct SceneWorld {
  HapticWorldModel model;
  /// Start position of the tool: beside a movable object at its mid-height; above the centre of the
  /// objects where there is no free place or an arm moves the tool; without objects, half way from
  /// the first camera to the scan.
  Eigen::Vector3d p_base_tool_start = Eigen::Vector3d::Zero();
  /// [N] force of the strongest continuous vibration: the largest limiting friction of the bodies,
  /// and at least `min_full_scale_force`.
  double full_scale_force = 0.0;
  std::vector<AssumedParameters> assumed;  ///< for each body
  std::size_t triangles = 0;               ///< of the static mesh
  std::vector<std::string> notes;          ///< warnings for the user
};

/// Makes a haptic world of a scene on disk: its movable objects at their current poses, with their
/// identified parameters; as static geometry, the finest mesh of at most `max_triangles`.
/// Errors: a missing or invalid file, parameters of an object that is not in the scene.
[[nodiscard]] Expected<SceneWorld> make_scene_world(const SceneManifest& scene,
                                                    const SceneWorldOptions& options);

}  // namespace pcavr
