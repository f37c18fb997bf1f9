// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/scene/scene_bundle.hpp"

namespace pcavr {

struct SceneWorldOptions {
  std::optional<ParameterTable> parameters = {};  ///< as written by `pcavr identify`
  std::string parameters_file = {};               ///< file name for error messages
  double tool_radius = 0.01;                      ///< [m] > 0
  double max_force = 5.0;                         ///< [N] > 0 rendered on the hand
};

/// A body's parameters that neither the scene nor identification gave, so that defaults are used
/// (see complete_physics).
struct AssumedParameters {
  std::string object;
  std::vector<std::string> names;  ///< empty: all are known
};

struct SceneWorld {
  HapticWorldModel model;
  /// Start position of the tool: above the centre of the movable objects.
  Eigen::Vector3d p_base_tool_start = Eigen::Vector3d::Zero();
  /// [N] force of the strongest continuous vibration: the largest limiting friction of the bodies.
  double full_scale_force = 5.0;
  std::vector<AssumedParameters> assumed;  ///< for each body
  std::size_t triangles = 0;               ///< of the static mesh
  std::vector<std::string> notes;          ///< warnings for the user
};

/// Makes a haptic world of a scene on disk: its movable objects at their current poses, with their
/// identified parameters; as static geometry, the finest mesh of at most a million triangles.
/// Errors: a missing or invalid file, parameters of an object that is not in the scene.
[[nodiscard]] Expected<SceneWorld> make_scene_world(const SceneManifest& scene,
                                                    const SceneWorldOptions& options);

}  // namespace pcavr
