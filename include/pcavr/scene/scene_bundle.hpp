// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

/// Writes scene.yaml, scene.glb, mesh.ply, cloud.ply, occupancy.bt, camera_trajectory.txt,
/// preview.png and objects/NAME.glb into a folder that exists (an OutputFolder's).
[[nodiscard]] Expected<void> write_scene(const Scene& scene, const std::filesystem::path& folder,
                                         Parallelism parallelism);

/// What `scene.yaml` says of an object.
struct SceneObjectEntry {
  std::string name;
  std::filesystem::path mesh;  ///< relative to the scene's folder
  Pose T_base_object;
  Pose T_base_object_start;
  std::optional<double> mass = {};
  bool is_movable = true;
};

/// `scene.yaml` (`pcavr-scene/1`), read back: what replay, serve and others need.
struct SceneManifest {
  std::filesystem::path folder;
  std::string recording;
  double voxel_size = 0.0;
  std::vector<SceneObjectEntry> objects;
  std::vector<SupportPlane> support_planes;
  bool is_fixed_camera = false;
};
[[nodiscard]] Expected<SceneManifest> read_scene_manifest(const std::filesystem::path& folder);

/// One finding of inspect_scene.
struct SceneCheck {
  std::string what;    ///< "mesh.ply", "occupancy.bt", ...
  std::string figure;  ///< "412 316 triangles, 3.1 m^2"
  bool is_sound = true;
};
/// Opens every file of a scene, counts what is in it, and checks that the files agree.
[[nodiscard]] Expected<std::vector<SceneCheck>> inspect_scene(const std::filesystem::path& folder);

}  // namespace pcavr
