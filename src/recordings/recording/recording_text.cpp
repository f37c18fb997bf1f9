// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording/recording_text.hpp"

#include <charconv>
#include <initializer_list>

#include "pcavr/base/core/check.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"

namespace pcavr {
namespace {

template <typename Number>
void append_number(std::string& text, Number number) {
  char buffer[32];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, number);
  PCAVR_REQUIRE(code == std::errc{});
  text.append(buffer, end);
}

void append_row(std::string& text, Stamp stamp, char separator,
                std::initializer_list<double> numbers) {
  text += format_file_stamp(stamp);
  for (const double number : numbers) {
    text += separator;
    append_number(text, number);
  }
  text += '\n';
}

void append_pose(std::string& text, Stamp stamp, const Pose& pose, char separator) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  append_row(text, stamp, separator, {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

void append_poses(std::string& text, const Trajectory& trajectory, char separator) {
  for (const auto& [stamp, pose] : trajectory.poses()) append_pose(text, stamp, pose, separator);
}

void append_vectors(std::string& text, const char* keyword,
                    const std::vector<Eigen::Vector3f>& vectors) {
  for (const Eigen::Vector3f& v : vectors) {
    text += keyword;
    for (int i = 0; i < 3; ++i) {
      text += ' ';
      append_number(text, v[i]);
    }
    text += '\n';
  }
}

}  // namespace

std::string format_file_stamp(Stamp stamp) {
  return format_stamp(stamp, stamp.nanoseconds % 1000 == 0 ? 6 : 9);
}

std::string quoted_field(const std::string& field) {
  if (!field.empty() && field.find_first_of(" \t#\"\\") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string_view trajectory_header() { return "# timestamp tx ty tz qx qy qz qw\n"; }

void append_trajectory_row(std::string& text, Stamp stamp, const Pose& pose) {
  append_pose(text, stamp, pose, ' ');
}

std::string format_trajectory(const Trajectory& trajectory) {
  std::string text(trajectory_header());
  append_poses(text, trajectory, ' ');
  return text;
}

std::string_view tool_header() { return "t,x,y,z,qx,qy,qz,qw\n"; }

void append_tool_row(std::string& text, Stamp stamp, const Pose& T_base_tool) {
  append_pose(text, stamp, T_base_tool, ',');
}

std::string_view wrench_header() { return "t,fx,fy,fz,tx,ty,tz\n"; }

void append_wrench_row(std::string& text, const WrenchSample& sample) {
  const auto& [stamp, force, torque] = sample;
  append_row(text, stamp, ',',
             {force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()});
}

std::string format_tool(const Trajectory& T_base_tool) {
  std::string text(tool_header());
  append_poses(text, T_base_tool, ',');
  return text;
}

std::string format_wrench(const std::vector<WrenchSample>& wrench) {
  std::string text(wrench_header());
  for (const WrenchSample& sample : wrench) append_wrench_row(text, sample);
  return text;
}

std::string format_obj(const TriangleMesh& mesh) {
  std::string text;
  append_vectors(text, "v", mesh.vertices);
  append_vectors(text, "vn", mesh.normals);
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t vertex : triangle) {
      const std::string number = std::to_string(vertex + 1);
      text += ' ' + number;
      if (!mesh.normals.empty()) text += "//" + number;
    }
    text += '\n';
  }
  return text;
}

}  // namespace pcavr
