// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

#include "support/meshes.hpp"

namespace pcavr::test {

inline CameraModel scene_camera() {
  CameraModel camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 400.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  return camera;
}

inline const Eigen::Vector3f kBoxSize(0.16F, 0.12F, 0.1F);

inline CadModel box_model(float scale = 1.0F) {
  return make_cad_model(box_mesh(scale * kBoxSize), "box", "box").value();
}

/// One tag on the top and one on the side that faces the camera.
inline std::vector<TagPlacement> box_tags() {
  const Eigen::Quaterniond upright(0.5, 0.5, 0.5, 0.5);  // its normal along x, its up along z
  return {{{"tag36h11", 1}, 0.06, Pose::from_translation({0, 0, 0.05})},
          {{"tag36h11", 2}, 0.06, Pose(upright, {0.08, 0, 0})}};
}

/// Camera at (0.6, 0.2, 0.55) in base, looking at the origin.
inline Pose scene_camera_pose() {
  const Eigen::Vector3d position(0.6, 0.2, 0.55);
  const Eigen::Vector3d forward = -position.normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R_base_camera;
  R_base_camera << right, forward.cross(right), forward;
  return Pose(Eigen::Quaterniond(R_base_camera), position);
}

/// Standing on the table z = 0, turned about z.
inline Pose on_the_table(double x, double y, double turn) {
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())),
              {x, y, 0.5 * static_cast<double>(kBoxSize.z())});
}

inline void append(const TriangleMesh& part, TriangleMesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) {
    whole.triangles.push_back({a + first, b + first, c + first});
  }
}

inline TriangleMesh table_mesh() {
  TriangleMesh table;
  table.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  table.triangles = {{0, 1, 2}, {0, 2, 3}};
  return table;
}

/// A rendered frame with its tag detections.
struct SceneFrame {
  RgbdFrame frame;
  std::vector<TagDetection> detections;
};

/// Renders frames of a table with bodies on it: depth with the noise of DepthNoise's defaults,
/// rounded to eighths of a pixel of disparity (580 px, 75 mm, as the first Kinect), and tags with
/// corner noise of 0.1 px.
class SceneRenderer {
 public:
  explicit SceneRenderer(std::uint64_t seed) : random_(seed) {}

  double depth_offset = 0.0;  ///< added to every reading [m]

  /// Depth of the table and the given bodies (meshes in base), at the n-th thirtieth of a second.
  SceneFrame frame(int n, const std::vector<TriangleMesh>& bodies_base) {
    TriangleMesh all = table_mesh();
    for (const TriangleMesh& body : bodies_base) append(body, all);
    SceneFrame scene;
    scene.frame.index = static_cast<std::size_t>(n);
    scene.frame.color_stamp = scene.frame.depth_stamp = Stamp::from_seconds(1.0 + n / 30.0);
    scene.frame.depth = render_depth(SurfaceQuery(all), scene_camera(), scene_camera_pose());
    for (float& z : scene.frame.depth.pixels()) z = measured(z);
    return scene;
  }

  /// The same, of one box and its tags.
  SceneFrame frame_of_box(int n, const Pose& T_base_box) {
    SceneFrame scene = frame(n, {transformed(T_base_box, box_mesh(kBoxSize))});
    for (const TagPlacement& tag : box_tags()) {
      TagDetection detection{.id = tag.id, .corners = {}, .hamming = 0, .decision_margin = 80.0};
      const std::array<Eigen::Vector3d, 4> corners = tag_corners(tag.size);
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d p_base = T_base_box * (tag.T_body_marker * corners[i]);
        const Eigen::Vector2d noise(0.1 * random_.normal(), 0.1 * random_.normal());
        detection.corners[i] =
            scene_camera().project(scene_camera_pose().inverse() * p_base) + noise;
      }
      scene.detections.push_back(detection);
    }
    return scene;
  }

 private:
  float measured(float z) {
    if (z <= 0.0F) return 0.0F;
    const DepthNoise noise;
    const double noisy = z + depth_offset + noise.depth_std(z) * random_.normal();
    const double disparity = std::round(8.0 * 580.0 * 0.075 / noisy) / 8.0;
    return static_cast<float>(580.0 * 0.075 / disparity);
  }

  Random random_;
};

inline ObjectTracker box_tracker(const ObjectTrackerOptions& options = {}) {
  return ObjectTracker(box_model(), box_tags(), scene_camera(), options);
}

}  // namespace pcavr::test
