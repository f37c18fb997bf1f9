// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

#include "pipeline/checks/consistency_checks.hpp"

namespace pcavr {

/// A camera that moves around a table with a base tag and a box with two tags, in frames 0.1 s
/// apart. Faults are injected by changing the manifest, the measurements or the poses.
struct ConsistencyCase {
  Manifest manifest;
  Trajectory camera;  ///< T_base_camera
  std::vector<Stamp> stamps;
  std::vector<TagMeasurement> tags;
  CameraTrack track;  ///< without errors, in its own segment frame
};

/// x to the right, y down, z toward the target.
inline Pose looking_at(const Eigen::Vector3d& from, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - from).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return Pose(Eigen::Quaterniond(R), from);
}

inline MarkerEntry a_tag(int id, double size, const Pose& pose, const std::string& object = {}) {
  return {.id = {"tag36h11", id},
          .size = size,
          .role = object.empty() ? MarkerRole::base : MarkerRole::object,
          .object = object,
          .T_parent_marker = pose};
}

/// Depth has a relative bias of `bias`, and corners have a noise of 0.3 mm.
inline ConsistencyCase a_consistency_case(double bias = 0.0) {
  constexpr int kFrames = 12;
  const Pose T_base_box = Pose::from_translation({0.6, -0.1, 0.05});
  ConsistencyCase made;
  made.manifest.camera =
      CameraModel{.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  made.manifest.depth_scale = 5000.0;
  made.manifest.markers = {
      a_tag(0, 0.12, Pose::from_translation({0.7, 0.3, 0.0})),
      a_tag(5, 0.08, Pose::from_translation({0.0, 0.0, 0.05}), "box"),
      a_tag(6, 0.06, Pose(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {0.08, 0.0, 0.0}), "box")};
  made.manifest.objects = {{.name = "box", .mesh = "objects/box.obj"}};
  const Pose T_segment_base(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX())),
                            {1.0, 2.0, 3.0});
  Random random(1);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double angle = 0.1 * static_cast<double>(i) - 0.5;
    const Pose T_base_camera = looking_at(
        {0.6 + 0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.6 + 0.05 * std::cos(7.0 * angle)},
        {0.65, 0.05 * std::sin(3.0 * angle), 0.0});
    made.stamps.push_back(Stamp::from_seconds(0.1 * static_cast<double>(i)));
    made.camera.append(made.stamps.back(), T_base_camera);
    FramePlacement placement;
    placement.frame = i;
    placement.stamp = made.stamps.back();
    placement.segment = 0;
    placement.T_segment_camera = T_segment_base * T_base_camera;
    made.track.frames.push_back(placement);
    for (std::size_t m = 0; m < made.manifest.markers.size(); ++m) {
      const MarkerEntry& marker = made.manifest.markers[m];
      const Pose T_base_marker =
          (marker.role == MarkerRole::object ? T_base_box : Pose()) * marker.T_parent_marker;
      TagMeasurement tag{.frame = i, .marker = m, .corners_camera = tag_corners(marker.size)};
      for (Eigen::Vector3d& corner : tag.corners_camera) {
        corner = (1.0 + bias) * (T_base_camera.inverse() * T_base_marker * corner);
        for (double& coordinate : corner) coordinate += 3e-4 * random.normal();
      }
      made.tags.push_back(tag);
    }
  }
  return made;
}

}  // namespace pcavr
