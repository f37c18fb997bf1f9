// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "pcavr/perception/scene/guard_surface.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/scene_content.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

/// Number of poses that show a moving camera's path.
constexpr std::size_t kMaxCameras = 100;

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Position [x, y, z] and quaternion [x, y, z, w], as everywhere in the protocol.
void add_pose(Json& to, const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  to["position"] = vector_json(pose.translation());
  to["quaternion"] = Json::array({q.x(), q.y(), q.z(), q.w()});
}

Json file_json(const SceneFile& file, const char* count) {
  return {{"path", file.path}, {count, file.count}, {"bytes", file.bytes}};
}

Json parameters_json(const ObjectParameters& known) {
  Json json = Json::object();
  for (const auto& [key, parameter] : list_parameters(known)) {
    json[key] = parameter.value;
    if (parameter.std && std::isfinite(*parameter.std)) {
      json[key + "_std"] = *parameter.std;
    }
  }
  return json;
}

Json object_json(const SceneObjectEntry& object, const SceneFile& file,
                 const ObjectParameters& known) {
  Json json = {{"name", object.name}, {"path", file.path}, {"bytes", file.bytes}};
  json["texture"] = nullptr;
  if (!file.texture.empty()) json["texture"] = file.texture;
  add_pose(json, object.T_base_object);
  json["mass"] = nullptr;
  if (known.mass) json["mass"] = known.mass->value;
  if (object.mass) json["mass"] = *object.mass;
  json["movable"] = object.is_movable;
  json["evidence"] = object.evidence;
  json["parameters"] = parameters_json(known);
  return json;
}

Json tag_json(const MarkerEntry& tag) {
  Json json = {{"family", tag.id.family}, {"id", tag.id.id}, {"size", tag.size}};
  json["object"] = nullptr;
  if (tag.role == MarkerRole::object) json["object"] = tag.object;
  add_pose(json, tag.T_parent_marker);
  return json;
}

Json plane_json(const SupportPlane& plane) {
  Json outline = Json::array();
  for (const Eigen::Vector3d& corner : plane.outline_base) outline.push_back(vector_json(corner));
  return {{"outline", outline}};
}

Json index_json(const std::optional<std::size_t>& index) {
  return index ? Json(*index) : Json(nullptr);
}

Json joint_json(const RobotJoint& joint) {
  Json json = {{"name", joint.name}, {"parent", index_json(joint.parent)}};
  add_pose(json, joint.T_parent_joint);
  json["axis"] = vector_json(joint.axis);
  json["slides"] = joint.kind == JointKind::kPrismatic;
  json["coordinate"] = joint.coordinate;
  json["multiplier"] = joint.multiplier;
  json["offset"] = joint.offset;
  return json;
}

/// Data that the page needs for forward kinematics, and the links' meshes.
Json robot_json(const SceneArm& arm, const SceneRobotEntry& entry, const SceneFiles& files) {
  Json json = {{"name", arm.model.name}, {"tip", entry.tip}};
  add_pose(json, arm.T_base_robot);
  json["start"] = entry.position;
  json["joints"] = Json::array();
  for (const RobotJoint& joint : arm.model.joints) json["joints"].push_back(joint_json(joint));
  json["links"] = Json::array();
  for (const RobotLink& link : arm.model.links) {
    Json link_json = {{"name", link.name}, {"joint", index_json(link.joint)}};
    add_pose(link_json, link.T_joint_link);
    link_json["path"] = nullptr;
    link_json["bytes"] = 0;
    for (std::size_t i = 0; i < entry.links.size(); ++i) {
      if (entry.links[i].name != link.name) continue;
      link_json["path"] = files.links[i].path;
      link_json["bytes"] = files.links[i].bytes;
    }
    json["links"].push_back(link_json);
  }
  return json;
}

/// Flat arrays of a guard's mesh, in millimetres: whole numbers are short.
Expected<Json> guard_json(const GuardSurface& guard, const std::filesystem::path& folder) {
  const Expected<TriangleMesh> mesh = guard_mesh(guard, folder);
  if (!mesh) return mesh.error();
  Json vertices = Json::array(), triangles = Json::array();
  for (const Eigen::Vector3f& vertex : mesh->vertices) {
    for (const float coordinate : vertex) vertices.push_back(std::lround(1e3F * coordinate));
  }
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t index : triangle) triangles.push_back(index);
  }
  return Json{{"name", guard.name}, {"vertices_mm", vertices}, {"triangles", triangles}};
}

/// One pose of a fixed camera, else poses spaced evenly over its frames.
Json cameras_json(const Trajectory& camera, bool is_fixed) {
  Json cameras = Json::array();
  const std::size_t count =
      is_fixed ? std::min<std::size_t>(1, camera.size()) : std::min(kMaxCameras, camera.size());
  for (std::size_t i = 0; i < count; ++i) {
    Json json = Json::object();
    add_pose(json, camera.poses()[i * camera.size() / count].pose);
    cameras.push_back(json);
  }
  return cameras;
}

}  // namespace

Expected<Json> guards_json(const SceneManifest& scene) {
  Json guards = Json::array();
  for (const GuardSurface& guard : scene.guards) {
    Expected<Json> json = guard_json(guard, scene.folder);
    if (!json) return json.error();
    guards.push_back(std::move(*json));
  }
  return guards;
}

std::string scene_name(const SceneManifest& scene) {
  const std::filesystem::path folder =
      (std::filesystem::absolute(scene.folder) / "").lexically_normal();
  return folder.parent_path().filename().string();
}

Json scene_json(const SceneManifest& scene, const SceneFiles& files,
                const std::optional<SceneArm>& arm, const std::optional<ParameterTable>& parameters,
                const Trajectory& camera) {
  Json json = {{"name", scene_name(scene)},
               {"protocol", kLiveProtocolVersion},
               {"up", vector_json(scene.up_base)}};
  json["mesh"] = Json::array();
  for (const SceneFile& level : files.mesh) json["mesh"].push_back(file_json(level, "triangles"));
  json["tiles"] = nullptr;
  if (files.tiles) json["tiles"] = file_json(*files.tiles, "tiles");
  json["cloud"] = file_json(files.cloud, "points");
  json["occupancy"] = file_json(files.occupancy, "cells");
  json["occupancy"]["edge"] = files.occupancy_edge;
  json["unseen_support"] = nullptr;
  if (files.unseen_support) json["unseen_support"] = file_json(*files.unseen_support, "triangles");
  json["objects"] = Json::array();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObjectEntry& object = scene.objects[i];
    const bool is_known = parameters && parameters->contains(object.name);
    json["objects"].push_back(object_json(
        object, files.objects[i], is_known ? parameters->at(object.name) : ObjectParameters{}));
  }
  json["robot"] = nullptr;
  if (arm) json["robot"] = robot_json(*arm, *scene.robot, files);
  json["tags"] = Json::array();
  for (const MarkerEntry& tag : scene.tags) json["tags"].push_back(tag_json(tag));
  json["support_planes"] = Json::array();
  for (const SupportPlane& plane : scene.support_planes) {
    json["support_planes"].push_back(plane_json(plane));
  }
  json["cameras"] = cameras_json(camera, scene.is_fixed_camera);
  return json;
}

}  // namespace pcavr
