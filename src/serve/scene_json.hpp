// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/scene/scene_bundle.hpp"

namespace pcavr {

/// What scene.json says of one file: its path, its length before gzip, and how much is in it
/// (triangles, points, cells; by the file's kind).
struct PageFile {
  std::string path;
  std::size_t bytes = 0;
  std::size_t count = 0;
};

/// The files that a page loads for a scene.
struct PageFiles {
  std::vector<PageFile> mesh;  ///< finest first
  PageFile cloud;
  PageFile occupancy;
  double occupancy_edge = 0.0;    ///< [m]
  std::vector<PageFile> objects;  ///< as in the scene
};

/// /api/scene.json of docs/live-protocol.md.
[[nodiscard]] nlohmann::ordered_json scene_json(const SceneManifest& scene, const PageFiles& files,
                                                const std::optional<ParameterTable>& parameters,
                                                const Trajectory& camera);

}  // namespace pcavr
