// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/perception/scene/scene_bundle.hpp"

namespace pcavr {

// Names of the files in a scene's folder.
inline constexpr char kManifestFile[] = "scene.yaml";
inline constexpr char kDisplayFile[] = "scene.glb";
inline constexpr char kMeshFile[] = "mesh.ply";
inline constexpr char kCloudFile[] = "cloud.ply";
inline constexpr char kCloudPcdFile[] = "cloud.pcd";
inline constexpr char kOccupancyFile[] = "occupancy.bt";
inline constexpr char kTrajectoryFile[] = "camera_trajectory.txt";
inline constexpr char kPreviewFile[] = "preview.png";
inline constexpr char kRobotFile[] = "robot/robot.urdf";

/// Path of an object's mesh in the scene's folder.
[[nodiscard]] std::filesystem::path object_file(const std::string& name);
/// Path of the mesh of an arm's link; index in SceneRobot::links.
[[nodiscard]] std::filesystem::path link_file(std::size_t index);
/// Path of a level of detail; level 0 is scene.glb.
[[nodiscard]] std::filesystem::path level_of_detail_file(std::size_t level);

[[nodiscard]] SceneManifest manifest_of(const Scene& scene);

/// The text of scene.yaml, without `folder`.
[[nodiscard]] std::string format_scene_manifest(const SceneManifest& manifest);
/// Parses scene.yaml; `file` is used in errors.
[[nodiscard]] Expected<SceneManifest> parse_scene_manifest(const std::string& text,
                                                           const std::string& file);

}  // namespace pcavr
