// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/recording/line_counts.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

/// Writes scene.yaml, scene.glb, mesh.ply, cloud.ply, occupancy.bt, camera_trajectory.txt,
/// preview.png, objects/NAME.glb and, for each further level of detail, lod/static_mesh_N.glb into
/// a folder that exists (an OutputFolder's). The same scene gives the same bytes, whatever the
/// Parallelism: times are not written. Objects whose evidence is kNotSeen stand in scene.yaml only.
/// An Error, such as a full disk, may leave some of the files behind.
[[nodiscard]] Expected<void> write_scene(const Scene& scene, const std::filesystem::path& folder,
                                         Parallelism parallelism);

/// What `scene.yaml` says of an object; the fields are those of SceneObject.
struct SceneObjectEntry {
  std::string name;
  std::filesystem::path mesh;  ///< relative to the scene's folder; coordinates in the object frame
  Pose T_base_object;
  Pose T_base_object_start;
  std::string evidence;
  double position_sigma = 0.0;          ///< [m]
  double rotation_sigma = 0.0;          ///< [rad]
  double refinement_translation = 0.0;  ///< [m]
  double refinement_rotation = 0.0;     ///< [rad]
  std::optional<double> mass = {};      ///< [kg]
  bool is_movable = true;
  /// Where the scene's mesh stands in for a finer CAD mesh, with what was measured on that one.
  struct Simplified {
    CadModel::Simplification simplification;
    double volume = 0.0;                                              ///< [m^3]
    Eigen::Vector3d centre_of_mass_object = Eigen::Vector3d::Zero();  ///< [m]
  };
  std::optional<Simplified> simplified = {};
};

/// `scene.yaml` (`pcavr-scene/1`), read back: what replay, serve and others need.
struct SceneManifest {
  std::filesystem::path folder;
  std::string recording;    ///< as the user named it
  double voxel_size = 0.0;  ///< [m]
  std::vector<SceneObjectEntry> objects;
  std::vector<MarkerEntry> tags;  ///< empty in scenes that were built before tags were kept
  std::vector<SupportPlane> support_planes;
  /// Relative to the folder, finest first; the first is scene.glb.
  std::vector<std::filesystem::path> levels_of_detail;
  bool is_fixed_camera = false;
  SceneQuality quality;  ///< without the times
  /// Of the text files; nothing in scenes that were built before lines were counted.
  std::optional<LineCounts> lines = {};
};
/// Strict: a last line without an end, a key that is not known, a missing one or a path that leaves
/// the folder is an Error with its line.
[[nodiscard]] Expected<SceneManifest> read_scene_manifest(const std::filesystem::path& folder);

/// The CAD body of an object, which scene.yaml places: the scene's mesh, and the volume and centre
/// of mass of the mesh that it may stand in for. Same errors as read_cad_model.
[[nodiscard]] Expected<CadModel> read_object_model(const SceneManifest& scene,
                                                   const SceneObjectEntry& object);

/// The camera's poses of a scene: camera_trajectory.txt, which has to be whole where scene.yaml
/// counts its lines.
[[nodiscard]] Expected<Trajectory> read_camera_trajectory(const SceneManifest& scene);

/// One finding of inspect_scene.
struct SceneCheck {
  std::string what;    ///< "mesh.ply", "occupancy.bt", ...
  std::string figure;  ///< "412 316 triangles, 3.1 m^2"
  bool is_sound = true;
};
/// Opens every file of a scene, counts what is in it, and checks that the files agree. An Error
/// only where scene.yaml itself can't be read.
[[nodiscard]] Expected<std::vector<SceneCheck>> inspect_scene(const std::filesystem::path& folder);

}  // namespace pcavr
