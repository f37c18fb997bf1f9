// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::cdr {

/// The content and the course of a scene, as ROS 2 messages in CDR: the standard types that viewers
/// draw, and two of this project's own. See cdr_messages.hpp.

inline constexpr std::string_view kMarkerArrayType = "visualization_msgs/msg/MarkerArray";
inline constexpr std::string_view kPointCloudType = "sensor_msgs/msg/PointCloud2";
inline constexpr std::string_view kJointStateType = "sensor_msgs/msg/JointState";
inline constexpr std::string_view kCompressedImageType = "sensor_msgs/msg/CompressedImage";
inline constexpr std::string_view kStringType = "std_msgs/msg/String";
inline constexpr std::string_view kDiagnosticArrayType = "diagnostic_msgs/msg/DiagnosticArray";
inline constexpr std::string_view kPhasesType = "pcavr_msgs/msg/Phases";
inline constexpr std::string_view kParametersType = "pcavr_msgs/msg/Parameters";
[[nodiscard]] std::string marker_array_definition();
[[nodiscard]] std::string point_cloud_definition();
[[nodiscard]] std::string joint_state_definition();
[[nodiscard]] std::string compressed_image_definition();
[[nodiscard]] std::string string_definition();
[[nodiscard]] std::string diagnostic_array_definition();
[[nodiscard]] std::string phases_definition();
[[nodiscard]] std::string parameters_definition();

/// A mesh that moves with a frame, in coordinates of that frame.
struct MeshMarker {
  std::string name;  ///< its namespace
  std::string frame;
  const TriangleMesh* mesh = nullptr;
  std::array<float, 4> color = {0.7F, 0.7F, 0.7F, 1.0F};  ///< RGBA where the mesh has no colours
};

/// One TRIANGLE_LIST for each; colours of the vertices where the mesh has them.
[[nodiscard]] std::vector<std::uint8_t> marker_array(Stamp stamp,
                                                     const std::vector<MeshMarker>& markers);
/// Unordered, dense; fields x, y, z as FLOAT32 [m].
[[nodiscard]] std::vector<std::uint8_t> point_cloud(Stamp stamp,
                                                    std::span<const Eigen::Vector3f> points,
                                                    std::string_view frame = "base");
/// Positions [rad] or [m]; neither velocities nor efforts.
[[nodiscard]] std::vector<std::uint8_t> joint_state(Stamp stamp,
                                                    const std::vector<std::string>& names,
                                                    std::span<const double> positions);
[[nodiscard]] std::vector<std::uint8_t> compressed_image(Stamp stamp, std::string_view frame,
                                                         std::string_view format,
                                                         std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> text_message(std::string_view text);

struct Diagnostic {
  enum class Level : std::uint8_t { ok = 0, warning = 1, error = 2 };
  Level level = Level::ok;
  std::string name;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};
[[nodiscard]] std::vector<std::uint8_t> diagnostic_array(
    Stamp stamp, const std::vector<Diagnostic>& diagnostics);

struct ObjectPhase {
  std::string object;
  std::string phase;  ///< name_of(MotionPhase)
  bool is_outside_model = false;
  bool is_blocked = false;
  bool is_saturated = false;
};
[[nodiscard]] std::vector<std::uint8_t> phases(Stamp stamp,
                                               const std::vector<ObjectPhase>& objects);

/// A parameter of an object, in the unit of the parameter file.
struct Parameter {
  std::string object;
  std::string name;  ///< its key in the parameter file
  double value = 0.0;
  std::optional<double> std = {};  ///< written as NaN where it is not known
};
[[nodiscard]] std::vector<std::uint8_t> parameters(Stamp stamp,
                                                   const std::vector<Parameter>& values);

}  // namespace pcavr::cdr
