// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

/// Content that other viewers get once: the scene's geometry, its arm, and what was identified.
struct ViewerScene {
  TriangleMesh scan_base = {};                    ///< [m] may be empty
  std::vector<TriangleMesh> bodies_object = {};   ///< [m] by the world's body
  std::vector<Eigen::Vector3f> points_base = {};  ///< [m] of the cloud, one for each occupied cell
  std::string urdf = {};                          ///< empty: no arm
  std::vector<std::string> joints = {};           ///< of the arm, in the order of its coordinates
  ParameterTable parameters = {};
};

/// Makes the content from a scene on disk and the world that is made of it. A scan with many
/// triangles is shown by a coarser level of detail. Errors: a file that is missing or invalid.
[[nodiscard]] Expected<ViewerScene> make_viewer_scene(
    const SceneManifest& scene, const HapticWorldModel& model,
    const std::optional<ParameterTable>& parameters);

}  // namespace pcavr
