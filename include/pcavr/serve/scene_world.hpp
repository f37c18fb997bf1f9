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
  std::optional<ParameterTable> parameters = {};  ///< what identify wrote
  std::string parameters_file = {};               ///< by which errors name it
  double tool_radius = 0.01;                      ///< [m] > 0
  double max_force = 5.0;                         ///< [N] > 0 on the hand
};

/// A body's numbers that nothing told, and that were taken as usual (see complete_physics).
struct AssumedNumbers {
  std::string object;
  std::vector<std::string> names;  ///< empty: all were told
};

struct SceneWorld {
  HapticWorldModel model;
  /// Where the tool waits: above the middle of what can be pushed.
  Eigen::Vector3d p_base_tool_start = Eigen::Vector3d::Zero();
  /// [N] at which a controller's pulses are strongest: what the body that holds best bears.
  double full_force = 5.0;
  std::vector<AssumedNumbers> assumed;  ///< by body
  std::size_t triangles = 0;            ///< of what does not move
  std::vector<std::string> notes;       ///< what a user should know
};

/// Makes a scene on disk a world to push in: its movable objects where they stand now, with what
/// was identified of them; of what does not move, the finest mesh of at most a million triangles.
/// Errors: a file that is missing or unsound, parameters of an object that the scene has not.
[[nodiscard]] Expected<SceneWorld> make_scene_world(const SceneManifest& scene,
                                                    const SceneWorldOptions& options);

}  // namespace pcavr
