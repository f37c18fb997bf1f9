// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr {

/// Names of the files of an export.
inline constexpr char kExportManifest[] = "export.json";
inline constexpr char kMjcfFile[] = "scene.xml";
inline constexpr char kUrdfFile[] = "scene.urdf";
inline constexpr char kSdfFile[] = "scene.sdf";
inline constexpr char kUsdFile[] = "scene.usda";
inline constexpr char kPlanningSceneFile[] = "planning_scene.json";
inline constexpr char kPlanningTextFile[] = "scene.scene";

/// Writes scene.xml for MuJoCo 3 and its meshes into a folder that exists. Adds the residuals of
/// its mappings to the world's. Errors, here and below: a file that can't be written; an object
/// with a name that the format reserves. Threads may write different worlds to different folders.
[[nodiscard]] Expected<void> write_mjcf(ExportedWorld& world, const std::filesystem::path& folder);

/// The same for other engines: scene.urdf (bodies on floating joints of the link base; Bullet reads
/// the contact), scene.sdf (1.9, ODE's coefficients), scene.usda (UsdPhysics, meshes inside).
[[nodiscard]] Expected<void> write_urdf(ExportedWorld& world, const std::filesystem::path& folder);
[[nodiscard]] Expected<void> write_sdf(ExportedWorld& world, const std::filesystem::path& folder);
[[nodiscard]] Expected<void> write_usd(ExportedWorld& world, const std::filesystem::path& folder);

/// Writes a planning scene for MoveIt: planning_scene.json, a moveit_msgs/PlanningScene with bodies
/// and supports as collision objects and the scan as OctoMap, without the cells that meet a body;
/// apply.py, which gives it to a running move_group; scene.scene, the objects as RViz imports them.
/// Further errors: the scene's OctoMap can't be read.
[[nodiscard]] Expected<void> write_moveit(ExportedWorld& world,
                                          const std::filesystem::path& folder);

/// Writes motion.csv, `t,x,y,z,qw,qx,qy,qz,vx,vy,vz` of the tool in base from t = 0 on; it must not
/// be empty. Positions and velocities [m/s] are line fits over 40 ms: engines damp contacts and
/// slide by velocities, and differences of noisy positions would be tens of mm/s.
[[nodiscard]] Expected<void> write_motion(const Trajectory& tool,
                                          const std::filesystem::path& folder);
/// Writes run.mjs and run.py, which play motion.csv in MuJoCo and set friction by slip speed.
[[nodiscard]] Expected<void> write_mujoco_runners(const std::filesystem::path& folder);

/// Writes export.json: every number with std, unit and origin, correlations by object, residuals.
[[nodiscard]] Expected<void> write_export_manifest(const ExportedWorld& world,
                                                   const ParameterTable& parameters,
                                                   const std::string& format,
                                                   const std::filesystem::path& folder);

}  // namespace pcavr
