// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/export_text.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <system_error>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"

namespace pcavr::detail {
namespace {

constexpr std::size_t kStlHeader = 80;  // bytes

template <typename T>
void append_bytes(std::string& bytes, const T& value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

}  // namespace

std::string obj_text(const TriangleMesh& mesh, std::size_t first) {
  std::string text;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& v = mesh.vertices[i];
    text += fmt::format("v {} {} {}", v.x(), v.y(), v.z());
    if (!mesh.colors.empty()) {
      const Rgb8& colour = mesh.colors[i];
      text += fmt::format(" {:.4g} {:.4g} {:.4g}", colour.r / 255.0, colour.g / 255.0,
                          colour.b / 255.0);
    }
    text += '\n';
  }
  for (const auto& t : mesh.triangles) {
    text += fmt::format("f {} {} {}\n", first + t[0], first + t[1], first + t[2]);
  }
  return text;
}

std::string stl_bytes(const TriangleMesh& mesh) {
  std::string bytes(kStlHeader, '\0');
  append_bytes(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f& a = mesh.vertices[t[0]];
    const Eigen::Vector3f& b = mesh.vertices[t[1]];
    const Eigen::Vector3f& c = mesh.vertices[t[2]];
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
    for (const Eigen::Vector3f& each : {normal, a, b, c}) {
      for (int i = 0; i < 3; ++i) append_bytes(bytes, each[i]);
    }
    append_bytes(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  if (std::hypot(r(2, 1), r(2, 2)) < 1e-9) {  // the axes of roll and yaw coincide
    return {std::atan2(-r(1, 2), r(1, 1)), pitch, 0.0};
  }
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

std::string mjcf_pose(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return fmt::format("pos=\"{}\" quat=\"{} {} {} {}\"", vector_text(pose.translation()), q.w(),
                     q.x(), q.y(), q.z());
}

std::string inertia_attributes(const Eigen::Matrix3d& i) {
  return fmt::format("ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"", i(0, 0),
                     i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2));
}

Expected<void> write_meshes(const ExportedWorld& world, const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder / "meshes", code);
  if (code) {
    return Error{.message = "can't create the folder", .file = (folder / "meshes").string()};
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const auto file = folder / "meshes" / fmt::format("object_{}.obj", i);
    if (auto written = write_file(file, obj_text(world.bodies[i].mesh_object)); !written) {
      return written;
    }
  }
  if (!world.is_scanned()) return {};
  return write_file(folder / "meshes" / "scan.obj", obj_text(world.scan_base));
}

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace pcavr::detail
