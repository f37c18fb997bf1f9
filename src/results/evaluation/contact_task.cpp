// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "contact_task.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "pcavr/base/geometry/matched_poses.hpp"

namespace pcavr {
namespace {

constexpr double kMinDownward = 0.866;  // cosine of 30 degrees
constexpr int kHullDirections = 400;    // 7 degrees apart: hull widened by 0.2 % of its size

/// Points on the unit sphere, evenly spread: the spherical Fibonacci lattice [Gonzalez 2010].
Eigen::Vector3d lattice_direction(int i) {
  const double z = 1.0 - (2.0 * i + 1.0) / kHullDirections;
  const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Whether no vertex is as far along `direction` as the point.
bool is_beyond_mesh(const TriangleMesh& mesh, const Eigen::Vector3d& point,
                    const Eigen::Vector3d& direction) {
  const double at_point = direction.dot(point);
  return std::none_of(mesh.vertices.begin(), mesh.vertices.end(),
                      [&](const Eigen::Vector3f& vertex) {
                        return direction.dot(vertex.cast<double>()) > at_point;
                      });
}

/// Whether the point is outside of a face of the hull. The lattice alone takes a point above the
/// middle of a flat face for one inside: no direction of it is the face's normal.
bool is_beyond_a_face(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  constexpr std::size_t kMaxFaces = 5000;  // finer meshes are round enough for the lattice
  if (mesh.triangles.size() > kMaxFaces) return false;
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const std::array<std::uint32_t, 3>& triangle) {
                       const Eigen::Vector3d a = mesh.vertices[triangle[0]].cast<double>();
                       const Eigen::Vector3d normal =
                           (mesh.vertices[triangle[1]].cast<double>() - a)
                               .cross(mesh.vertices[triangle[2]].cast<double>() - a)
                               .normalized();
                       // Single precision: vertices of the face itself may lie a little above it.
                       constexpr double kRounding = 1e-6;  // [m]
                       return normal.dot(point - a) > kRounding &&
                              is_beyond_mesh(mesh, point - kRounding * normal, normal);
                     });
}

bool is_in_hull(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  if (is_beyond_a_face(mesh, point)) return false;
  for (int i = 0; i < kHullDirections; ++i) {
    if (is_beyond_mesh(mesh, point, lattice_direction(i))) return false;
  }
  return true;
}

/// Decides by the winding number: the solid angles of the triangles [van Oosterom & Strackee 1983]
/// add up to 4 pi inside of a closed mesh, and to 0 outside.
bool is_in_solid(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  double half_angles = 0.0;
  for (const auto& triangle : mesh.triangles) {
    Eigen::Vector3d a = mesh.vertices[triangle[0]].cast<double>() - point;
    Eigen::Vector3d b = mesh.vertices[triangle[1]].cast<double>() - point;
    Eigen::Vector3d c = mesh.vertices[triangle[2]].cast<double>() - point;
    a.normalize(), b.normalize(), c.normalize();
    half_angles += std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
  }
  return half_angles > std::numbers::pi;
}

bool is_in_hole(const ContactPeak& contact, const ContactTaskInput& motion) {
  const std::optional<Pose> T_base_tool = motion.T_base_tool.at(contact.peak);
  if (!T_base_tool || !motion.T_base_object || !motion.closed_mesh_object) return false;
  const Pose T_base_object = pose_near(*motion.T_base_object, contact.peak);
  const Eigen::Vector3d p_object = T_base_object.inverse() * T_base_tool->translation();
  const TriangleMesh& mesh = *motion.closed_mesh_object;
  return is_in_hull(mesh, p_object) && !is_in_solid(mesh, p_object);
}

bool slides(const ContactPeak& contact, const PhaseTimeline& phases) {
  if (phase_at(phases, contact.begin) == Phase::sliding) return true;
  return std::any_of(phases.begin(), phases.end(), [&](const PhaseChange& change) {
    return change.phase == Phase::sliding && change.stamp >= contact.begin &&
           change.stamp <= contact.end;
  });
}

}  // namespace

ContactTask task_of(const ContactPeak& contact, const ContactTaskInput& motion,
                    const ForceErrorOptions& options) {
  const Stamp before = contact.begin + -duration_from_seconds(options.approach_time);
  const std::optional<Pose> from = motion.T_base_tool.at(before);
  const std::optional<Pose> to = motion.T_base_tool.at(contact.peak);
  if (!from || !to) return ContactTask::unknown;
  if (is_in_hole(contact, motion)) return ContactTask::slotting;
  const Eigen::Vector3d path = to->translation() - from->translation();
  const bool is_downward = -path.z() > kMinDownward * path.norm();
  return is_downward && !slides(contact, motion.phases) ? ContactTask::press : ContactTask::push;
}

}  // namespace pcavr
