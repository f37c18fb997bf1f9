// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr {

struct ExportOptions {
  bool assumes = false;  ///< defaults for masses and friction that are not known, instead of Errors
  /// For a planner: nothing is said of masses and friction, and none need be known.
  bool geometry_only = false;
  /// [m/s] at which bodies slide: engines have one coefficient, without a viscous part. Empty: the
  /// mean of the speeds at which friction was identified.
  std::optional<double> speed = {};
  std::optional<double> tool_radius = {};  ///< [m]
  std::optional<Pose> T_base_tool = {};    ///< empty: above the bodies
  std::size_t max_body_triangles = 5000;   ///< of a body's mesh
  std::size_t max_scan_triangles = 20000;  ///< of the scan
  /// The scan, reduced for an earlier world of the scene, which outlives the call; nullptr: it is
  /// read.
  const TriangleMesh* scan_base = nullptr;
};

/// The world of a scene with `parameters`, which has an entry of each object (known_parameters).
/// Errors: a mesh that can't be read; a movable object without mass or friction, unless assumed.
[[nodiscard]] Expected<ExportedWorld> make_exported_world(const SceneManifest& scene,
                                                          const ParameterTable& parameters,
                                                          const ExportOptions& options);

}  // namespace pcavr
