// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/utf8.hpp"
#include "pcavr/perception/scene/scene_text.hpp"

#include "preview.hpp"

namespace pcavr {
namespace {

/// Significant digits: nanometres in a room and nanoradians of rotation, below any uncertainty.
constexpr std::size_t kDigits = 10;

template <typename Value>
void emit(YAML::Emitter& out, const char* key, const Value& value) {
  out << YAML::Key << key << YAML::Value << value;
}

void emit_section(YAML::Emitter& out, const char* key) {
  out << YAML::Newline << YAML::Newline << YAML::Key << key << YAML::Value;
}

template <typename Numbers>
void emit_list(YAML::Emitter& out, const Numbers& numbers) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const double number : numbers) out << number;
  out << YAML::EndSeq;
}

void emit_pose(YAML::Emitter& out, const char* key, const Pose& pose) {
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  out << YAML::Key << "t" << YAML::Value;
  emit_list(out, pose.translation());
  out << YAML::Key << "q" << YAML::Value;
  emit_list(out, pose.rotation().coeffs());  // Eigen's order: x y z w
  out << YAML::EndMap;
}

/// A pair of values for a pose: translation [m] and rotation [rad].
void emit_pose_values(YAML::Emitter& out, const char* key, double translation, double rotation) {
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  emit(out, "translation", translation);
  emit(out, "rotation", rotation);
  out << YAML::EndMap;
}

/// The figures that the scan's texture and a body's have in common.
template <typename Texture>
void emit_texture_figures(YAML::Emitter& out, const Texture& texture) {
  emit(out, "width", texture.width);
  emit(out, "height", texture.height);
  emit(out, "texel", texture.texel);
  emit(out, "views", texture.views);
  emit(out, "seen_fraction", texture.seen_fraction);
}

void emit_body_texture(YAML::Emitter& out, const BodyTextureEntry& texture) {
  out << YAML::Key << "texture" << YAML::Value << YAML::Flow << YAML::BeginMap;
  emit_texture_figures(out, texture);
  out << YAML::EndMap;
}

/// Properties of the original CAD mesh, and the simplification error of the scene's mesh.
void emit_simplified(YAML::Emitter& out, const SceneObjectEntry::Simplified& simplified) {
  emit(out, "simplified_error", simplified.simplification.max_error);
  emit(out, "full_triangles", simplified.simplification.full_triangles);
  emit(out, "volume", simplified.volume);
  out << YAML::Key << "centre_of_mass" << YAML::Value;
  emit_list(out, simplified.centre_of_mass_object);
}

void emit_object(YAML::Emitter& out, const SceneObjectEntry& object) {
  out << YAML::BeginMap;
  emit(out, "name", object.name);
  emit(out, "mesh", object.mesh.string());
  emit(out, "movable", object.is_movable);
  if (object.mass) emit(out, "mass", *object.mass);
  if (object.hertz_stiffness) emit(out, "hertz_stiffness", *object.hertz_stiffness);
  emit_pose(out, "pose", object.T_base_object);
  emit_pose(out, "start", object.T_base_object_start);
  emit(out, "evidence", object.evidence);
  emit_pose_values(out, "sigma", object.position_std, object.rotation_std);
  emit_pose_values(out, "refinement", object.refinement_translation, object.refinement_rotation);
  if (object.simplified) emit_simplified(out, *object.simplified);
  if (object.texture) emit_body_texture(out, *object.texture);
  out << YAML::EndMap;
}

void emit_robot(YAML::Emitter& out, const SceneRobotEntry& robot) {
  emit_section(out, "robot");
  out << YAML::BeginMap;
  emit(out, "urdf", robot.urdf.string());
  emit_pose(out, "pose", robot.T_base_robot);
  emit(out, "tip", robot.tip);
  out << YAML::Key << "joints" << YAML::Value << YAML::Flow << robot.joints;
  out << YAML::Key << "position" << YAML::Value;
  emit_list(out, robot.position);
  out << YAML::Key << "links" << YAML::Value << YAML::BeginSeq;
  for (const SceneRobotEntry::Link& link : robot.links) {
    out << YAML::Flow << YAML::BeginMap;
    emit(out, "name", link.name);
    emit(out, "mesh", link.mesh.string());
    out << YAML::EndMap;
  }
  out << YAML::EndSeq << YAML::EndMap;
}

void emit_tag(YAML::Emitter& out, const MarkerEntry& tag) {
  out << YAML::Flow << YAML::BeginMap;
  emit(out, "family", tag.id.family);
  emit(out, "id", tag.id.id);
  emit(out, "size", tag.size);
  if (tag.role == MarkerRole::object) emit(out, "object", tag.object);
  emit_pose(out, "pose", tag.T_parent_marker);
  out << YAML::EndMap;
}

void emit_plane(YAML::Emitter& out, const SupportPlane& plane) {
  out << YAML::BeginMap << YAML::Key << "normal" << YAML::Value;
  emit_list(out, plane.plane_base.normal);
  emit(out, "offset", plane.plane_base.offset);
  emit(out, "rms", plane.rms);
  out << YAML::Key << "objects" << YAML::Value << YAML::Flow << plane.objects;
  out << YAML::Key << "outline" << YAML::Value << YAML::BeginSeq;
  for (const Eigen::Vector3d& corner : plane.outline_base) emit_list(out, corner);
  out << YAML::EndSeq << YAML::EndMap;
}

void emit_guard(YAML::Emitter& out, const GuardSurface& guard) {
  out << YAML::BeginMap;
  emit(out, "name", guard.name);
  if (const auto* box = std::get_if<GuardBox>(&guard.shape)) {
    out << YAML::Key << "box" << YAML::Value << YAML::BeginMap << YAML::Key << "size"
        << YAML::Value;
    emit_list(out, box->size);
    emit_pose(out, "pose", box->T_base_box);
    out << YAML::EndMap;
  } else if (const auto* plane = std::get_if<GuardPlane>(&guard.shape)) {
    out << YAML::Key << "plane" << YAML::Value << YAML::BeginMap << YAML::Key << "point"
        << YAML::Value;
    emit_list(out, plane->point);
    out << YAML::Key << "normal" << YAML::Value;
    emit_list(out, plane->normal);
    emit(out, "size", plane->size);
    out << YAML::EndMap;
  } else {
    out << YAML::Key << "scan" << YAML::Value << YAML::BeginMap;
    emit(out, "margin", std::get<GuardScan>(guard.shape).margin);
    out << YAML::EndMap;
  }
  out << YAML::EndMap;
}

void emit_files(YAML::Emitter& out, const SceneManifest& manifest) {
  emit_section(out, "files");
  out << YAML::BeginMap;
  emit(out, "display", kDisplayFile);
  emit(out, "mesh", kMeshFile);
  emit(out, "cloud", kCloudFile);
  emit(out, "occupancy", kOccupancyFile);
  emit(out, "camera_trajectory", kTrajectoryFile);
  emit(out, "preview", kPreviewFile);
  out << YAML::Key << "levels_of_detail" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const auto& level : manifest.levels_of_detail) out << level.string();
  out << YAML::EndSeq << YAML::EndMap;
}

void emit_texture(YAML::Emitter& out, const SceneTextureEntry& texture) {
  emit_section(out, "texture");
  out << YAML::BeginMap;
  emit_texture_figures(out, texture);
  out << YAML::Key << "color_camera" << YAML::Value << YAML::BeginMap;
  emit(out, "width", texture.color_camera.width);
  emit(out, "height", texture.color_camera.height);
  emit(out, "fx", texture.color_camera.fx);
  emit(out, "fy", texture.color_camera.fy);
  emit(out, "cx", texture.color_camera.cx);
  emit(out, "cy", texture.color_camera.cy);
  emit_pose(out, "T_color_depth", texture.T_color_depth);
  emit(out, "vignetting", texture.vignetting);
  out << YAML::EndMap << YAML::EndMap;
}

using Counts = std::vector<std::pair<std::string, std::size_t>>;

void emit_counts(YAML::Emitter& out, const char* key, const char* what, const Counts& counts) {
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const auto& [name, count] : counts) {
    out << YAML::Flow << YAML::BeginMap;
    emit(out, what, name);
    emit(out, "frames", count);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_warnings(YAML::Emitter& out, const std::vector<InputWarning>& warnings) {
  out << YAML::Key << "input_warnings" << YAML::Value << YAML::BeginSeq;
  for (const InputWarning& warning : warnings) {
    out << YAML::BeginMap;
    emit(out, "input", warning.input);
    emit(out, "message", warning.message);
    emit(out, "factor", warning.factor);
    emit(out, "frames", warning.frames);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_left_out(YAML::Emitter& out, const std::vector<SkippedRows>& left_out) {
  emit_section(out, "left_out");
  out << YAML::BeginSeq;
  for (const SkippedRows& entry : left_out) {
    out << YAML::Flow << YAML::BeginMap;
    emit(out, "file", entry.file);
    emit(out, "reason", entry.reason);
    emit(out, "rows", entry.count);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_lines(YAML::Emitter& out, const LineCounts& lines) {
  emit_section(out, "lines");
  out << YAML::BeginMap;
  for (const auto& [file, count] : lines) out << YAML::Key << file << YAML::Value << count;
  out << YAML::EndMap;
}

void emit_configuration(YAML::Emitter& out,
                        const std::vector<std::pair<std::string, std::string>>& changed) {
  emit_section(out, "configuration");
  out << YAML::BeginMap;
  for (const auto& [key, value] : changed) emit(out, key.c_str(), value);
  out << YAML::EndMap;
}

void emit_quality(YAML::Emitter& out, const SceneQuality& quality) {
  emit_section(out, "quality");
  out << YAML::BeginMap;
  emit(out, "frames_recorded", quality.frames_recorded);
  emit(out, "frames_used", quality.frames_used);
  emit_counts(out, "frames_dropped", "reason", quality.frames_dropped);
  emit_left_out(out, quality.left_out);
  emit_counts(out, "tags_seen", "tag", quality.tags_seen);
  if (quality.tag_reprojection_rms) {
    emit(out, "tag_reprojection_rms", *quality.tag_reprojection_rms);
  }
  if (quality.surface_rms) emit(out, "surface_rms", *quality.surface_rms);
  // Required, so that a truncated file is refused.
  emit(out, "tracking_rms", quality.tracking_rms);
  emit_pose_values(out, "camera_sigma", quality.camera_position_std, quality.camera_rotation_std);
  if (!quality.input_warnings.empty()) emit_warnings(out, quality.input_warnings);
  out << YAML::EndMap;
}

std::optional<BodyTextureEntry> texture_entry_of(const SceneObject& object) {
  if (!object.texture) return std::nullopt;
  const BodyTexture& texture = *object.texture;
  return BodyTextureEntry{.width = texture.width,
                          .height = texture.height,
                          .texel = texture.texel,
                          .views = texture.views,
                          .seen_fraction = texture.seen_fraction};
}

std::optional<SceneObjectEntry::Simplified> simplified_of(const CadModel& model) {
  if (!model.simplification) return std::nullopt;
  return SceneObjectEntry::Simplified{*model.simplification, model.volume,
                                      model.centre_of_mass_object};
}

}  // namespace

std::filesystem::path object_file(const std::string& name) {
  return std::filesystem::path("objects") / (name + ".glb");
}

std::filesystem::path link_file(std::size_t index) {
  return std::filesystem::path("robot") / ("link_" + std::to_string(index) + ".glb");
}

std::filesystem::path level_of_detail_file(std::size_t level) {
  if (level == 0) return kDisplayFile;
  return std::filesystem::path("lod") / ("static_mesh_" + std::to_string(level) + ".glb");
}

SceneManifest manifest_of(const Scene& scene) {
  SceneManifest manifest;
  manifest.recording = scene.recording;
  manifest.voxel_size = scene.voxel_size;
  manifest.configuration = scene.configuration;
  for (const SceneObject& object : scene.objects) {
    if (object.evidence != kNotSeen) continue;
    manifest.not_found.push_back({object.model.name, object.reason});
  }
  const bool is_world_arbitrary = scene.tags.empty() && scene.objects.empty() && !scene.robot;
  if (is_world_arbitrary) manifest.up_base = up_direction(scene);
  for (const SceneObject& object : scene.objects) {
    if (object.evidence == kNotSeen) continue;
    manifest.objects.push_back({.name = object.model.name,
                                .mesh = object_file(object.model.name),
                                .T_base_object = object.T_base_object,
                                .T_base_object_start = object.T_base_object_start,
                                .evidence = object.evidence,
                                .position_std = object.position_std,
                                .rotation_std = object.rotation_std,
                                .refinement_translation = object.refinement_translation,
                                .refinement_rotation = object.refinement_rotation,
                                .mass = object.mass,
                                .is_movable = object.is_movable,
                                .hertz_stiffness = object.hertz_stiffness,
                                .simplified = simplified_of(object.model),
                                .texture = texture_entry_of(object)});
  }
  if (scene.robot) {
    const SceneRobot& robot = *scene.robot;
    manifest.robot = SceneRobotEntry{.urdf = kRobotFile,
                                     .T_base_robot = robot.T_base_robot,
                                     .tip = robot.tip,
                                     .joints = robot.joints,
                                     .position = robot.position,
                                     .links = {}};
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      manifest.robot->links.push_back({robot.links[i].name, link_file(i)});
    }
  }
  manifest.tags = scene.tags;
  manifest.support_planes = scene.support_planes;
  manifest.levels_of_detail.push_back(kDisplayFile);
  for (std::size_t level = 1; level < scene.levels_of_detail_base.size(); ++level) {
    manifest.levels_of_detail.push_back(level_of_detail_file(level));
  }
  if (scene.texture) {
    const SceneTexture& texture = *scene.texture;
    manifest.texture = SceneTextureEntry{.width = texture.width,
                                         .height = texture.height,
                                         .texel = texture.texel,
                                         .views = texture.views,
                                         .seen_fraction = texture.seen_fraction,
                                         .color_camera = texture.color_camera.undistorted(),
                                         .T_color_depth = texture.T_color_depth,
                                         .vignetting = texture.vignetting};
  }
  manifest.is_fixed_camera = scene.quality.is_fixed_camera;
  manifest.quality = scene.quality;
  manifest.quality.times.clear();
  // Plus one comment line with the column names.
  manifest.lines = LineCounts{{kTrajectoryFile, scene.camera_trajectory.size() + 1}};
  return manifest;
}

std::string format_scene_manifest(const SceneManifest& manifest) {
  YAML::Emitter out;
  out.SetDoublePrecision(kDigits);
  out << YAML::Comment(
      "A scene in the robot's base frame (z up). Metres, radians, kilograms, pixels;\n"
      "t: translation, q: rotation as qx qy qz qw; sigma: one standard deviation.");
  out << YAML::BeginMap;
  emit(out, "format", "pcavr-scene/1");
  emit(out, "made_by", "pcavr " PCAVR_VERSION);
  emit(out, "recording", as_utf8_text(manifest.recording));
  emit(out, "camera", manifest.is_fixed_camera ? "fixed" : "moving");
  emit(out, "voxel_size", manifest.voxel_size);
  emit_files(out, manifest);
  if (manifest.up_base != Eigen::Vector3d::UnitZ()) {
    emit_section(out, "up");
    emit_list(out, manifest.up_base);
  }
  if (manifest.texture) emit_texture(out, *manifest.texture);
  emit_section(out, "objects");
  out << YAML::BeginSeq;
  for (const SceneObjectEntry& object : manifest.objects) emit_object(out, object);
  out << YAML::EndSeq;
  if (!manifest.not_found.empty()) {
    emit_section(out, "not_found");
    out << YAML::BeginSeq;
    for (const NotFoundObject& object : manifest.not_found) {
      out << YAML::BeginMap;
      emit(out, "name", object.name);
      emit(out, "reason", object.reason);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  if (manifest.robot) emit_robot(out, *manifest.robot);
  emit_section(out, "tags");
  out << YAML::BeginSeq;
  for (const MarkerEntry& tag : manifest.tags) emit_tag(out, tag);
  out << YAML::EndSeq;
  emit_section(out, "support_planes");
  out << YAML::BeginSeq;
  for (const SupportPlane& plane : manifest.support_planes) emit_plane(out, plane);
  out << YAML::EndSeq;
  if (!manifest.guards.empty()) {
    emit_section(out, "guards");
    out << YAML::BeginSeq;
    for (const GuardSurface& guard : manifest.guards) emit_guard(out, guard);
    out << YAML::EndSeq;
  }
  // These come before `quality`: a truncated manifest then lacks required keys, and is rejected.
  if (manifest.lines) emit_lines(out, *manifest.lines);
  if (!manifest.configuration.empty()) emit_configuration(out, manifest.configuration);
  emit_quality(out, manifest.quality);
  out << YAML::EndMap;
  return std::string(out.c_str()) + '\n';
}

}  // namespace pcavr
