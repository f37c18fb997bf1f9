// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

/// A table with two blocks on it in front of a wall, all with a smooth random texture, and one base
/// tag: rendered exactly, so that the ground truth is known.
namespace camera_scene {

using namespace pcavr;

inline CameraModel a_camera() {
  CameraModel camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = 270.0;
  camera.fy = 268.0;
  camera.cx = 158.0;
  camera.cy = 121.0;
  return camera;
}

/// Base tag 0 lies on the table, with a size of 16 cm.
inline Manifest a_manifest(const CameraModel& camera = a_camera()) {
  Manifest manifest;
  manifest.camera = camera;
  manifest.depth_scale = 5000.0;
  manifest.markers.push_back(
      {{"tag36h11", 0}, 0.16, MarkerRole::base, "", Pose::from_translation({0.1, -0.05, 0.0})});
  return manifest;
}

/// The camera's pose at `eye`, looking at `target`, the image upright.
inline Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {Eigen::Quaterniond(R), eye};
}

/// A walk around the table at some 0.25 m/s.
inline Pose walk(double seconds) {
  const double angle = 0.25 * seconds;
  return look_at({-1.0 * std::cos(angle), -1.0 * std::sin(angle), 0.7 + 0.05 * std::sin(seconds)},
                 {0.1, 0.05 * std::sin(1.5 * seconds), 0.0});
}

struct Scene {
  std::vector<Eigen::AlignedBox3d> blocks{
      {Eigen::Vector3d(0.25, 0.15, 0.0), Eigen::Vector3d(0.40, 0.35, 0.15)},
      {Eigen::Vector3d(-0.15, 0.2, 0.0), Eigen::Vector3d(-0.05, 0.3, 0.2)},
      {Eigen::Vector3d(0.6, -1.5, 0.0), Eigen::Vector3d(0.7, 1.5, 1.2)}};  // the wall
  /// Texture coordinates move with the first block.
  Eigen::Vector3d first_block_motion = Eigen::Vector3d::Zero();
};

/// Smooth noise on a lattice: an octave of the texture, in [0, 1].
inline double octave(const Eigen::Vector3d& p) {
  const Eigen::Vector3i cell = p.array().floor().cast<int>();
  const Eigen::Vector3d f = p - cell.cast<double>();
  const Eigen::Vector3d s = f.array() * f.array() * (3.0 - 2.0 * f.array());
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i at = cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
    auto hash = static_cast<std::uint32_t>(at.x()) * 73856093U ^
                static_cast<std::uint32_t>(at.y()) * 19349663U ^
                static_cast<std::uint32_t>(at.z()) * 83492791U;
    hash = (hash ^ hash >> 13) * 1274126177U;
    const double value = static_cast<double>((hash ^ hash >> 16) & 255U) / 255.0;
    const double wx = (corner & 1) != 0 ? s.x() : 1.0 - s.x();
    const double wy = (corner >> 1 & 1) != 0 ? s.y() : 1.0 - s.y();
    const double wz = (corner >> 2) != 0 ? s.z() : 1.0 - s.z();
    sum += value * wx * wy * wz;
  }
  return sum;
}

inline std::uint8_t texture(const Eigen::Vector3d& p) {
  return static_cast<std::uint8_t>(
      std::lround(40.0 + 120.0 * octave(p / 0.05) + 60.0 * octave(p / 0.021)));
}

struct Hit {
  double z = HUGE_VAL;  ///< along the ray whose third camera coordinate is 1
  Eigen::Vector3d p_texture;
};

inline Hit cast(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  Hit hit;
  if (ray.z() < 0.0) {
    hit.z = -origin.z() / ray.z();
    hit.p_texture = origin + hit.z * ray;
  }
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const Eigen::Array3d low = (scene.blocks[b].min() - origin).array() / ray.array();
    const Eigen::Array3d high = (scene.blocks[b].max() - origin).array() / ray.array();
    const double enter = low.min(high).maxCoeff();
    const double leave = low.max(high).minCoeff();
    if (enter > leave || enter <= 0.0 || enter >= hit.z) continue;
    hit.z = enter;
    hit.p_texture = origin + enter * ray;
    if (b == 0) hit.p_texture -= scene.first_block_motion;
  }
  return hit;
}

/// Renders colour from one pose and depth from another (they may have been captured at different
/// times). `noise` multiplies the depth noise of the first Kinect.
inline RgbdFrame render(const Scene& scene, const CameraModel& camera, const Pose& T_base_color,
                        const Pose& T_base_depth, std::size_t index, double noise = 0.5) {
  RgbdFrame frame;
  frame.index = index;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = DepthImage(camera.width, camera.height);
  Random random(index + 1);
  const DepthNoise sensor;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.normalise(Eigen::Vector2d(x, y)).homogeneous();
      const Hit color = cast(scene, T_base_color.translation(), T_base_color.rotation() * ray);
      if (std::isfinite(color.z)) {
        const std::uint8_t value = texture(color.p_texture);
        frame.color(x, y) = {value, value, value};
      }
      const Hit depth = cast(scene, T_base_depth.translation(), T_base_depth.rotation() * ray);
      if (depth.z < 4.0) {
        frame.depth(x, y) =
            static_cast<float>(depth.z + noise * sensor.depth_std(depth.z) * random.normal());
      }
    }
  }
  return frame;
}

/// The base tag as a detector would report it, with corner noise of 0.1 px.
inline std::vector<TagDetection> detect_tags(const Manifest& manifest, const Pose& T_base_color,
                                             std::size_t index) {
  Random random(1000 + index);
  std::vector<TagDetection> detections;
  for (const MarkerEntry& marker : manifest.markers) {
    TagDetection detection;
    detection.id = marker.id;
    detection.decision_margin = 80.0;
    const auto corners = tag_corners(marker.size);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p = T_base_color.inverse() * (marker.T_parent_marker * corners[i]);
      detection.corners[i] =
          manifest.camera->project(p) + 0.1 * Eigen::Vector2d(random.normal(), random.normal());
    }
    detections.push_back(detection);
  }
  return detections;
}

inline Stamp stamp_of(double seconds) { return Stamp::from_seconds(100.0 + seconds); }

}  // namespace camera_scene
