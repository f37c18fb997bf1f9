// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/occupancy_tree.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "results/export/export_text.hpp"

namespace pcavr {
namespace {

using PlanningJson = nlohmann::ordered_json;

constexpr char kApplyScript[] =
    R"(# python3 apply.py: adds planning_scene.json to the planning scene of a running move_group (MoveIt 2).
# Its frame must be known to tf. Not run by pcavr's tests.
import json, pathlib
import rclpy
from moveit_msgs.srv import ApplyPlanningScene
from rosidl_runtime_py import set_message_fields
rclpy.init()
node = rclpy.create_node("pcavr_planning_scene")
client = node.create_client(ApplyPlanningScene, "/apply_planning_scene")
client.wait_for_service()
request = ApplyPlanningScene.Request()
text = pathlib.Path(__file__).with_name("planning_scene.json").read_text()
set_message_fields(request.scene, json.loads(text))
future = client.call_async(request)
rclpy.spin_until_future_complete(node, future)
print("applied" if future.result().success else "refused")
)";

PlanningJson point_json(const Eigen::Vector3d& p) {
  return {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}};
}

PlanningJson pose_json(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return {{"position", point_json(pose.translation())},
          {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
}

PlanningJson mesh_json(const TriangleMesh& mesh) {
  PlanningJson json{{"triangles", PlanningJson::array()}, {"vertices", PlanningJson::array()}};
  for (const auto& triangle : mesh.triangles) {
    json["triangles"].push_back({{"vertex_indices", triangle}});
  }
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    json["vertices"].push_back(point_json(vertex.cast<double>()));
  }
  return json;
}

/// A moveit_msgs/CollisionObject without its shapes; its operation is ADD, the default.
PlanningJson object_json(const ExportedWorld& world, const std::string& name, const Pose& pose) {
  return {{"header", {{"frame_id", world.base_name}}}, {"id", name}, {"pose", pose_json(pose)}};
}

PlanningJson objects_json(const ExportedWorld& world) {
  PlanningJson objects = PlanningJson::array();
  for (const ExportedBody& body : world.bodies) {
    PlanningJson object = object_json(world, body.name, body.T_base_object);
    object["meshes"] = PlanningJson::array({mesh_json(body.mesh_object)});
    object["mesh_poses"] =
        PlanningJson::array({pose_json(Pose::from_translation(body.surface_offset_object))});
    objects.push_back(object);
  }
  constexpr int kBoxPrimitive = 1;  // shape_msgs/SolidPrimitive
  for (const ExportedSupport& support : world.supports) {
    PlanningJson object = object_json(world, support.name, support.T_base_box);
    const std::vector<double> size(support.size.begin(), support.size.end());
    object["primitives"] =
        PlanningJson::array({PlanningJson{{"type", kBoxPrimitive}, {"dimensions", size}}});
    object["primitive_poses"] = PlanningJson::array({pose_json(Pose())});
    objects.push_back(object);
  }
  return objects;
}

/// Whether a cube meets a body's closed mesh where it is written: conservative, by the sphere about
/// the cube.
class BodySpace {
 public:
  explicit BodySpace(const ExportedBody& body)
      : T_object_base_(
            (body.T_base_object * Pose::from_translation(body.surface_offset_object)).inverse()),
        surface_object_(body.mesh_object) {}

  [[nodiscard]] bool meets(const Eigen::Vector3d& centre_base, double edge) const {
    const Eigen::Vector3f centre = (T_object_base_ * centre_base).cast<float>();
    const double reach = 0.5 * std::sqrt(3.0) * edge;
    if (surface_object_.closest(centre, static_cast<float>(reach))) return true;
    // Inside: the first surface along a ray is left, not entered.
    const auto hit = surface_object_.cast(centre, Eigen::Vector3f::UnitZ());
    return hit && hit->normal.z() > 0.0F;
  }

 private:
  Pose T_object_base_;
  SurfaceQuery surface_object_;
};

/// An octomap_msgs/OctomapWithPose of the scan, without the cells that meet a body: they would
/// collide with it, and stay where it was when it moves.
Expected<PlanningJson> octomap_json(ExportedWorld& world) {
  Expected<OccupancyTree> tree = OccupancyTree::read(world.occupancy_file);
  if (!tree) return tree.error();
  for (const ExportedBody& body : world.bodies) {
    const BodySpace space(body);
    const std::size_t cleared = tree->clear_occupied(
        [&](const Eigen::Vector3d& centre, double edge) { return space.meets(centre, edge); });
    world.residuals.push_back({.object = body.name,
                               .what = "cells of the scan that meet it",
                               .wanted = 0.0,
                               .written = 0.0,
                               .unit = "1",
                               .remark = fmt::format("{} were cleared", cleared)});
  }
  const std::string data = tree->binary_data();
  const std::vector<signed char> bytes(data.begin(), data.end());
  return PlanningJson{{"header", {{"frame_id", world.base_name}}},
                      {"origin", pose_json(Pose())},
                      {"octomap",
                       {{"header", {{"frame_id", world.base_name}}},
                        {"binary", true},
                        {"id", "OcTree"},
                        {"resolution", tree->resolution()},
                        {"data", bytes}}}};
}

std::string pose_lines(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return fmt::format("{}\n{} {} {} {}\n", detail::vector_text(pose.translation()), q.x(), q.y(),
                     q.z(), q.w());
}

/// An object of MoveIt's text format: name, pose, one shape with its pose and colour, no subframes.
std::string object_lines(const std::string& name, const Pose& pose, const std::string& shape,
                         const Pose& T_object_shape) {
  return fmt::format("* {}\n{}1\n{}{}0 0 0 0\n0\n", name, pose_lines(pose), shape,
                     pose_lines(T_object_shape));
}

std::string planning_text(const ExportedWorld& world) {
  std::string text = "pcavr\n";
  for (const ExportedBody& body : world.bodies) {
    const TriangleMesh& mesh = body.mesh_object;
    std::string shape = fmt::format("mesh\n{} {}\n", mesh.vertices.size(), mesh.triangles.size());
    for (const Eigen::Vector3f& v : mesh.vertices) {
      shape += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    }
    for (const auto& t : mesh.triangles) shape += fmt::format("{} {} {}\n", t[0], t[1], t[2]);
    text += object_lines(body.name, body.T_base_object, shape,
                         Pose::from_translation(body.surface_offset_object));
  }
  for (const ExportedSupport& support : world.supports) {
    text += object_lines(support.name, support.T_base_box,
                         fmt::format("box\n{}\n", detail::vector_text(support.size)), Pose());
  }
  return text + ".\n";
}

}  // namespace

Expected<void> write_moveit(ExportedWorld& world, const std::filesystem::path& folder) {
  PlanningJson json{{"name", "pcavr"}, {"is_diff", true}};
  json["robot_state"] = {{"is_diff", true}};
  json["world"]["collision_objects"] = objects_json(world);
  if (!world.occupancy_file.empty()) {
    Expected<PlanningJson> octomap = octomap_json(world);
    if (!octomap) return octomap.error();
    json["world"]["octomap"] = *std::move(octomap);
  }
  if (auto written = write_file(folder / kPlanningSceneFile, json_text(json) + '\n'); !written) {
    return written;
  }
  if (auto written = write_file(folder / "apply.py", kApplyScript); !written) return written;
  return write_file(folder / kPlanningTextFile, planning_text(world));
}

}  // namespace pcavr
