// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/scene/guard_surface.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"

namespace pcavr {

/// Writes scene.yaml, scene.glb, mesh.ply, cloud.ply, cloud.pcd, occupancy.bt,
/// camera_trajectory.txt, preview.png, objects/NAME.glb, for an arm
/// robot/robot.urdf and robot/link_N.glb, and, for each further level of detail,
/// lod/static_mesh_N.glb into a folder that exists (an OutputFolder's). The same scene gives the
/// same bytes for any Parallelism: times are not written. Objects whose evidence is kNotSeen are in
/// scene.yaml only. After an Error, such as a full disk, some of the files may remain.
[[nodiscard]] Expected<void> write_scene(const Scene& scene, const std::filesystem::path& folder,
                                         Parallelism parallelism);

/// The texture of an object in `scene.glb`; the fields are those of BodyTexture.
struct BodyTextureEntry {
  int width = 0;       ///< [px]
  int height = 0;      ///< [px]
  double texel = 0.0;  ///< [m]
  std::size_t views = 0;
  double seen_fraction = 0.0;
};

/// An object's entry in `scene.yaml`; the fields are those of SceneObject.
struct SceneObjectEntry {
  std::string name;
  std::filesystem::path mesh;  ///< relative to the scene's folder; coordinates in the object frame
  Pose T_base_object;
  Pose T_base_object_start;
  std::string evidence;
  double position_std = 0.0;            ///< [m]
  double rotation_std = 0.0;            ///< [rad]
  double refinement_translation = 0.0;  ///< [m]
  double refinement_rotation = 0.0;     ///< [rad]
  std::optional<double> mass = {};      ///< [kg]
  bool is_movable = true;
  /// [N/m^1.5] of the contact with the tool, by both materials; empty: they are not known.
  std::optional<double> hertz_stiffness = {};
  /// The simplification of the CAD mesh, and the properties of the original.
  struct Simplified {
    CadModel::Simplification simplification;
    double volume = 0.0;                                              ///< [m^3]
    Eigen::Vector3d centre_of_mass_object = Eigen::Vector3d::Zero();  ///< [m]
  };
  std::optional<Simplified> simplified = {};
  std::optional<BodyTextureEntry> texture = {};  ///< nullopt: none, or of an older version
};

/// An object of the recording that the scene does not contain, because no frame showed where it is.
struct NotFoundObject {
  std::string name;
  std::string reason;  ///< "its tag tag36h11:7 is in no frame"

  /// "NAME is not in the scene: REASON".
  [[nodiscard]] std::string to_string() const;
};

/// The arm's entry in `scene.yaml`; the fields are those of SceneRobot.
struct SceneRobotEntry {
  std::filesystem::path urdf;  ///< relative to the scene's folder
  Pose T_base_robot;
  std::string tip;
  std::vector<std::string> joints;
  std::vector<double> position;
  struct Link {
    std::string name;
    std::filesystem::path mesh;  ///< relative to the scene's folder; in the link's frame
  };
  std::vector<Link> links;
};

/// The texture's entry in `scene.yaml`; the fields are those of SceneTexture.
struct SceneTextureEntry {
  int width = 0;       ///< [px]
  int height = 0;      ///< [px]
  double texel = 0.0;  ///< [m]
  std::size_t views = 0;
  double seen_fraction = 0.0;
  CameraModel color_camera;  ///< without its lens distortion
  Pose T_color_depth;
  double vignetting = 0.0;
};

/// `scene.yaml` (`pcavr-scene/1`), parsed.
struct SceneManifest {
  std::filesystem::path folder;
  std::string recording;    ///< as the user named it
  double voxel_size = 0.0;  ///< [m]
  /// Opposite to gravity, a unit vector: base's z axis, unless base is only the world frame of a
  /// recording without tags, objects and arm.
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();
  std::vector<SceneObjectEntry> objects;
  std::vector<NotFoundObject> not_found = {};
  std::optional<SceneRobotEntry> robot = {};
  std::vector<MarkerEntry> tags;  ///< empty in scenes of older versions
  std::vector<SupportPlane> support_planes;
  std::vector<GuardSurface> guards;  ///< as the user has added them
  /// Relative to the folder, finest first; the first is scene.glb.
  std::vector<std::filesystem::path> levels_of_detail;
  std::optional<SceneTextureEntry> texture = {};  ///< nullopt: none, or of an older version
  bool is_fixed_camera = false;
  SceneQuality quality;  ///< without the times
  /// Of the text files; nullopt in scenes of older versions.
  std::optional<LineCounts> lines = {};
  /// Options that differed from their defaults: "section.key", value.
  std::vector<std::pair<std::string, std::string>> configuration = {};

  /// False for the scene of a recording without images: it has the manifest's objects, and no
  /// reconstructed surface.
  [[nodiscard]] bool is_scanned() const { return quality.frames_used > 0; }
};
/// Strict: a last line without a newline, an unknown key, a missing key or a path outside the
/// folder is an Error with its line.
[[nodiscard]] Expected<SceneManifest> read_scene_manifest(const std::filesystem::path& folder);

/// The CAD model of an object: the scene's mesh, with the volume and centre of mass of the original
/// mesh where it is simplified. Same errors as read_cad_model.
[[nodiscard]] Expected<CadModel> read_object_model(const SceneManifest& scene,
                                                   const SceneObjectEntry& object);

/// The camera's trajectory (camera_trajectory.txt); checked for truncation where scene.yaml has its
/// line count.
[[nodiscard]] Expected<Trajectory> read_camera_trajectory(const SceneManifest& scene);

/// One finding of inspect_scene.
struct SceneCheck {
  std::string what;    ///< "mesh.ply", "occupancy.bt", ...
  std::string figure;  ///< "412 316 triangles, 3.1 m^2"
  bool is_sound = true;
};
/// Reads every file of a scene, summarises its content, and checks that the files are consistent.
/// An Error only where scene.yaml itself can't be read.
[[nodiscard]] Expected<std::vector<SceneCheck>> inspect_scene(const std::filesystem::path& folder);

}  // namespace pcavr
