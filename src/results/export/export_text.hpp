// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// "x y z", by the shortest digits that read back exactly.
[[nodiscard]] std::string vector_text(const Eigen::Vector3d& v);
/// Roll, pitch, yaw [rad] of URDF and SDF: R = Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation);
/// The attributes pos and quat of MJCF.
[[nodiscard]] std::string mjcf_pose(const Pose& pose);
/// A name as the text of an XML attribute.
[[nodiscard]] std::string xml_text(const std::string& text);
/// The attributes ixx to izz of URDF.
[[nodiscard]] std::string inertia_attributes(const Eigen::Matrix3d& inertia);

/// The OBJ text: vertices [m], with their colours in [0, 1] where the mesh has some, as MeshLab,
/// Blender and Open3D read them, and triangles. `first` is the number of the first vertex.
[[nodiscard]] std::string obj_text(const TriangleMesh& mesh, std::size_t first = 1);
/// The bytes of a binary STL file.
[[nodiscard]] std::string stl_bytes(const TriangleMesh& mesh);
/// Writes meshes/object_N.obj of all bodies, and meshes/scan.obj where there is a scan.
[[nodiscard]] Expected<void> write_meshes(const ExportedWorld& world,
                                          const std::filesystem::path& folder);

}  // namespace pcavr::detail
