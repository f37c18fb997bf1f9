// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/serve/scene_arm.hpp"

namespace pcavr {

/// One file in scene.json: its path, its length before gzip, and the number of its elements
/// (triangles, points or cells, by the file's kind).
struct SceneFile {
  std::string path;
  std::size_t bytes = 0;
  std::size_t count = 0;
  std::string texture = {};  ///< path of an object's; empty: it has none
};

/// The files that a page loads for a scene.
struct SceneFiles {
  std::vector<SceneFile> mesh;     ///< finest first
  std::optional<SceneFile> tiles;  ///< the tileset, and bytes and number of its tiles
  SceneFile cloud;
  SceneFile occupancy;
  double occupancy_edge = 0.0;  ///< [m]
  std::optional<SceneFile> unseen_support;
  std::vector<SceneFile> objects;  ///< in the scene's order
  std::vector<SceneFile> links;    ///< of the arm, in the scene's order
};

/// /api/scene.json of docs/live-protocol.md.
[[nodiscard]] nlohmann::ordered_json scene_json(const SceneManifest& scene, const SceneFiles& files,
                                                const std::optional<SceneArm>& arm,
                                                const std::optional<ParameterTable>& parameters,
                                                const Trajectory& camera);

/// Its "guards": the guard surfaces' triangles. Errors of guard_mesh.
[[nodiscard]] Expected<nlohmann::ordered_json> guards_json(const SceneManifest& scene);

}  // namespace pcavr
