// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "pcavr/perception/scene/scene.hpp"

namespace pcavr {

/// A horizontal square of `edge` [m] around `middle`, of `cells` x `cells` squares, facing upward.
inline TriangleMesh a_level_square(const Eigen::Vector3d& middle, double edge, int cells) {
  TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const Eigen::Vector3d offset(double(i) / cells - 0.5, double(j) / cells - 0.5, 0.0);
      mesh.vertices.emplace_back((middle + edge * offset).cast<float>());
      mesh.colors.push_back({150, 120, static_cast<std::uint8_t>(80 + (i + j) % 2 * 40)});
    }
  }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  compute_vertex_normals(mesh);
  return mesh;
}

/// A closed box around the origin, with eight shared vertices.
inline TriangleMesh a_box(const Eigen::Vector3f& size) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f side(corner & 1 ? 0.5F : -0.5F, corner & 2 ? 0.5F : -0.5F,
                               corner & 4 ? 0.5F : -0.5F);
    mesh.vertices.emplace_back(side.cwiseProduct(size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  compute_vertex_normals(mesh);
  return mesh;
}

/// Concatenates two meshes; both with normals and colours.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  a.colors.insert(a.colors.end(), b.colors.begin(), b.colors.end());
  for (const auto& [i, j, k] : b.triangles) {
    a.triangles.push_back({first + i, first + j, first + k});
  }
  return a;
}

inline SceneObject an_object(const std::string& name, const Eigen::Vector3d& p_base) {
  SceneObject object;
  object.model.name = name;
  object.model.mesh_object = a_box({0.1F, 0.2F, 0.08F});
  object.model.volume = 0.0016;
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  object.T_base_object = Pose(turned, p_base);
  object.T_base_object_start = Pose::from_translation({0.5, 0.1, 0.04});
  object.evidence = "tags_and_shape";
  object.position_std = 0.0003;
  object.rotation_std = 0.002;
  object.refinement_translation = 0.0004;
  object.refinement_rotation = 0.001;
  object.mass = 1.5;
  return object;
}

/// A camera that looks straight down from one metre above (0.5, 0, 0).
inline Pose a_view_from_above() {
  const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return Pose(down, {0.5, 0.0, 1.0});
}

inline CameraModel a_small_camera() {
  return {.width = 160, .height = 120, .fx = 131.25, .fy = 131.25, .cx = 79.5, .cy = 59.5};
}

/// A table of one metre at z = 0 with a box on it, like the result of a build.
inline Scene a_box_on_a_table() {
  Scene scene;
  scene.mesh_base = a_level_square({0.5, 0.0, 0.0}, 1.0, 50);
  scene.levels_of_detail_base = {scene.mesh_base, a_level_square({0.5, 0.0, 0.0}, 1.0, 5)};
  scene.cloud_base = {scene.mesh_base.vertices, scene.mesh_base.normals, scene.mesh_base.colors};
  scene.objects.push_back(an_object("box", {0.6, 0.05, 0.04}));
  scene.tags = {
      {{"tag36h11", 0}, 0.1, MarkerRole::base, "", Pose::from_translation({0.2, 0, 0})},
      {{"tag36h11", 5}, 0.05, MarkerRole::object, "box", Pose::from_translation({0, 0, 0.04})}};
  scene.support_planes.push_back(
      {.plane_base = {},
       .outline_base = {{0, -0.5, 0}, {1, -0.5, 0}, {1, 0.5, 0}, {0, 0.5, 0}},
       .rms = 0.0005,
       .objects = {"box"}});
  const DepthImage depth(160, 120, 1.0F);
  for (int i = 0; i < 5; ++i) {
    const Pose T_base_camera = a_view_from_above();
    scene.camera_trajectory.append({i * 50'000'000}, T_base_camera);
    scene.occupancy.integrate(depth, {}, a_small_camera(), T_base_camera);
  }
  scene.quality.frames_recorded = 6;
  scene.quality.frames_used = 5;
  scene.quality.frames_dropped = {{"lost", 1}};
  scene.quality.tags_seen = {{"tag36h11:0", 4}};
  scene.quality.tag_reprojection_rms = 0.21;
  scene.quality.surface_rms = 0.0011;
  scene.quality.times = {{"fusion", 1.0, 2.0}};
  scene.recording = "a recording: with a colon";
  scene.voxel_size = 0.02;
  return scene;
}

}  // namespace pcavr
