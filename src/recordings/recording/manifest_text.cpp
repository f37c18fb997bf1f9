// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

#include "recordings/recording/camera_keys.hpp"
#include "recordings/recording/mesh_units.hpp"
#include "recordings/recording/recording_text.hpp"

namespace pcavr {
namespace {

template <typename Numbers>
void emit_list(YAML::Emitter& out, const Numbers& numbers) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const double number : numbers) out << shortest_decimal(number);
  out << YAML::EndSeq;
}

void emit_pose(YAML::Emitter& out, const Pose& pose, const char* key = "pose") {
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  out << YAML::Key << "t" << YAML::Value;
  emit_list(out, pose.translation());
  out << YAML::Key << "q" << YAML::Value;
  emit_list(out, pose.rotation().coeffs());  // Eigen keeps them in the order x y z w
  out << YAML::EndMap;
}

template <typename Value>
void emit(YAML::Emitter& out, const char* key, const Value& value) {
  out << YAML::Key << key << YAML::Value << value;
}

void emit(YAML::Emitter& out, const char* key, double number) {
  emit(out, key, shortest_decimal(number));
}

void emit_camera(YAML::Emitter& out, const CameraModel& camera, double depth_scale,
                 double depth_offset) {
  out << YAML::Key << "camera" << YAML::Value << YAML::BeginMap;
  emit(out, "width", camera.width);
  emit(out, "height", camera.height);
  emit(out, "fx", camera.fx);
  emit(out, "fy", camera.fy);
  emit(out, "cx", camera.cx);
  emit(out, "cy", camera.cy);
  const LensModel model = camera.distortion.model();
  if (camera.has_distortion() || model != LensModel::plumb_bob) {
    if (model != LensModel::plumb_bob) emit(out, "model", std::string(name_of(model)));
    out << YAML::Key << "distortion" << YAML::Value;
    emit_list(out, camera.distortion.coefficients());
  }
  emit(out, "depth_scale", depth_scale);
  if (depth_offset != 0.0) emit(out, "depth_offset", depth_offset);
  out << YAML::EndMap;
}

/// Six rows of six numbers, each in a line of its own.
void emit_covariance(YAML::Emitter& out, const Matrix6d& covariance) {
  out << YAML::Key << "covariance" << YAML::Value << YAML::Block << YAML::BeginSeq;
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) emit_list(out, covariance.row(row));
  out << YAML::EndSeq;
}

void emit_marker(YAML::Emitter& out, const MarkerEntry& marker) {
  out << YAML::BeginMap;
  emit(out, "family", marker.id.family);
  emit(out, "id", marker.id.id);
  emit(out, "size", marker.size);
  emit(out, "role", marker.role == MarkerRole::base ? "base" : "object");
  if (marker.role == MarkerRole::object) emit(out, "object", marker.object);
  emit_pose(out, marker.T_parent_marker);
  if (!marker.covariance.isZero(0.0)) emit_covariance(out, marker.covariance);
  out << YAML::EndMap;
}

void emit_material(YAML::Emitter& out, const MaterialEntry& material) {
  out << YAML::Key << "material" << YAML::Value << YAML::Flow << YAML::BeginMap;
  emit(out, "youngs_modulus", material.youngs_modulus);
  emit(out, "poisson_ratio", material.poisson_ratio);
  if (material.radius) emit(out, "radius", *material.radius);
  out << YAML::EndMap;
}

std::string unit_text(double unit) {
  for (const auto& [name, metres] : kMeshUnits) {
    if (metres == unit) return name;
  }
  return shortest_decimal(unit);
}

void emit_object(YAML::Emitter& out, const ObjectEntry& object) {
  out << YAML::BeginMap;
  emit(out, "name", object.name);
  if (!object.mesh.empty()) emit(out, "mesh", object.mesh.string());
  if (object.mesh_unit != 1.0) emit(out, "unit", unit_text(object.mesh_unit));
  if (object.mass) emit(out, "mass", *object.mass);
  emit(out, "movable", object.is_movable);
  if (object.T_base_object) emit_pose(out, *object.T_base_object);
  if (!object.T_tracked_object.log().isZero()) {
    emit_pose(out, object.T_tracked_object, "tracked_to_object");
  }
  if (object.material) emit_material(out, *object.material);
  out << YAML::EndMap;
}

template <typename Entries, typename EmitEntry>
void emit_sequence(YAML::Emitter& out, const char* key, const Entries& entries,
                   EmitEntry emit_entry) {
  if (entries.empty()) return;
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const auto& entry : entries) emit_entry(out, entry);
  out << YAML::EndSeq;
}

}  // namespace

std::string format_manifest(const Manifest& manifest) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  emit(out, "format", "pcavr-recording/1");
  if (manifest.camera) {
    emit_camera(out, *manifest.camera, manifest.depth_scale, manifest.depth_offset);
  }
  emit_sequence(out, "markers", manifest.markers, emit_marker);
  emit_sequence(out, "objects", manifest.objects, emit_object);
  if (manifest.force_direction_std) {
    out << YAML::Key << "wrench" << YAML::Value << YAML::BeginMap;
    emit(out, "direction_std", *manifest.force_direction_std);
    out << YAML::EndMap;
  }
  if (manifest.tool_radius) {
    out << YAML::Key << "tool" << YAML::Value << YAML::BeginMap;
    emit(out, "radius", *manifest.tool_radius);
    if (manifest.tool_material) emit_material(out, *manifest.tool_material);
    out << YAML::EndMap;
  }
  if (manifest.robot) {
    out << YAML::Key << "robot" << YAML::Value << YAML::BeginMap;
    emit(out, "urdf", manifest.robot->urdf.string());
    emit_pose(out, manifest.robot->T_base_robot);
    if (manifest.robot->tip) emit(out, "tip", *manifest.robot->tip);
    out << YAML::EndMap;
  }
  out << YAML::EndMap;
  return std::string(out.c_str()) + '\n';
}

}  // namespace pcavr
