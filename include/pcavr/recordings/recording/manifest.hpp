// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A printed tag: its family ("tag36h11", "DICT_6X6_250", ...) and its number in it.
struct MarkerId {
  std::string family;
  int id = 0;
  auto operator<=>(const MarkerId&) const = default;
  [[nodiscard]] std::string to_string() const { return family + ':' + std::to_string(id); }
};

enum class MarkerRole {
  base,    ///< a PC_marker: its pose is in the base frame
  object,  ///< an O_marker: its pose is in its object's frame
};

struct MarkerEntry {
  MarkerId id;
  double size = 0.0;  ///< edge of the square through the detection corners [m], > 0
  MarkerRole role = MarkerRole::base;
  std::string object;      ///< name of its object; empty for a base marker
  Pose T_parent_marker{};  ///< in base or in its object, by role
  /// Of the twist [v; w] of T_parent_marker * exp([v; w]) where a calibration found it; 0 where the
  /// manifest states the pose, of which no more is known.
  Matrix6d covariance = Matrix6d::Zero();
};

/// An elastic material, for the contact's first stiffness [Hertz 1882].
struct MaterialEntry {
  double youngs_modulus = 0.0;  ///< [Pa]
  double poisson_ratio = 0.0;
  std::optional<double> radius = {};  ///< [m] of the surface that is touched; empty: it is flat
};

struct ObjectEntry {
  std::string name;
  std::filesystem::path mesh;       ///< relative to the recording's folder; may be empty
  double mesh_unit = 1.0;           ///< [m] of its coordinates
  std::optional<double> mass = {};  ///< [kg]
  bool is_movable = true;
  std::optional<Pose> T_base_object = {};  ///< initial pose, if the manifest states it
  /// Of the mesh in the frame that a tracker calls the object's, as `tracked/` has it.
  Pose T_tracked_object = {};
  std::optional<MaterialEntry> material = {};
};

/// The arm whose joints `joints.csv` records.
struct RobotEntry {
  std::filesystem::path urdf;           ///< relative to the recording's folder
  Pose T_base_robot = {};               ///< of the root link
  std::optional<std::string> tip = {};  ///< the link that is the tool; empty: the chain's last
};

/// The content of `recording.yaml` (`pcavr-recording/1`).
struct Manifest {
  std::optional<CameraModel> camera = {};
  double depth_scale = 0.0;   ///< depth image units in one metre; > 0 where there is a camera
  double depth_offset = 0.0;  ///< [m] to add to the depth, where there is any
  std::vector<MarkerEntry> markers = {};
  std::vector<ObjectEntry> objects = {};
  std::optional<double> tool_radius = {};           ///< [m]
  std::optional<MaterialEntry> tool_material = {};  ///< without a radius, which is tool_radius
  std::optional<RobotEntry> robot = {};
  /// [rad] Of the force's direction in wrench.csv, where a calibration of the sensor states it.
  std::optional<double> force_direction_std = {};
};

/// Reads and checks the text of a manifest; `file` names it in errors. Unknown keys, wrong types,
/// sizes <= 0, duplicate tags, objects that are not declared, and paths that leave the folder are
/// errors with their line.
[[nodiscard]] Expected<Manifest> parse_manifest(const std::string& text, const std::string& file);

/// The YAML text, the inverse of parse_manifest.
[[nodiscard]] std::string format_manifest(const Manifest& manifest);

}  // namespace pcavr
