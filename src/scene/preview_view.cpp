// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "preview.hpp"

namespace pcavr {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kFieldOfView = 40.0 * M_PI / 180.0;     ///< horizontal [rad]
constexpr double kTableElevation = 48.0 * M_PI / 180.0;  ///< above the horizon [rad]
constexpr double kMinElevation = 20.0 * M_PI / 180.0;    ///< without a table [rad]
constexpr double kFillFraction = 0.86;  ///< of the image, by the points of interest
constexpr double kMinDistance = 0.3;    ///< to the nearest point [m]

/// Corners of the objects' bounding boxes, and outlines of the support planes.
Points points_of_interest(const Scene& scene) {
  Points points;
  for (const SceneObject& object : scene.objects) {
    if (object.evidence == kNotSeen) continue;
    const Eigen::AlignedBox3d box = bounds(object.model.mesh_object.vertices).cast<double>();
    for (int corner = 0; corner < 8; ++corner) {
      points.push_back(object.T_base_object *
                       box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    }
  }
  for (const SupportPlane& plane : scene.support_planes) {
    points.insert(points.end(), plane.outline_base.begin(), plane.outline_base.end());
  }
  return points;
}

/// Vertices of the mesh, without outliers: inside the 2 % to 98 % quantiles along each axis.
Points points_of_bulk(const TriangleMesh& mesh) {
  constexpr double kTail = 0.02;                    // fraction on each side
  constexpr std::size_t kMaxFramedPoints = 20'000;  // a sample determines the view
  if (mesh.vertices.empty()) return {Eigen::Vector3d::Zero()};
  Eigen::Vector3f low;
  Eigen::Vector3f high;
  std::vector<float> coordinates(mesh.vertices.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), coordinates.begin(),
                   [&](const Eigen::Vector3f& vertex) { return vertex[axis]; });
    const auto quantile = [&](double fraction) {
      const auto index =
          static_cast<std::ptrdiff_t>(fraction * static_cast<double>(coordinates.size() - 1));
      std::nth_element(coordinates.begin(), coordinates.begin() + index, coordinates.end());
      return coordinates[static_cast<std::size_t>(index)];
    };
    low[axis] = quantile(kTail);
    high[axis] = quantile(1.0 - kTail);
  }
  const Eigen::AlignedBox3f box(low, high);
  Points points;
  for (std::size_t i = 0; i < mesh.vertices.size();
       i += mesh.vertices.size() / kMaxFramedPoints + 1) {
    if (box.contains(mesh.vertices[i])) points.push_back(mesh.vertices[i].cast<double>());
  }
  return points.empty() ? Points{box.center().cast<double>()} : points;
}

Eigen::Vector3d mean(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

Points camera_positions(const Scene& scene) {
  Points positions;
  for (const TimedPose& pose : scene.camera_trajectory.poses()) {
    positions.push_back(pose.pose.translation());
  }
  return positions;
}

/// Opposite to gravity: base's z axis, except for recordings with an arbitrary world frame, which
/// is assumed where the camera looks at the zenith all the time.
Eigen::Vector3d up_direction(const Scene& scene) {
  Eigen::Vector3d forward = Eigen::Vector3d::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const TimedPose& timed : scene.camera_trajectory.poses()) {
    forward += timed.pose.rotation() * Eigen::Vector3d::UnitZ();
    up -= timed.pose.rotation() * Eigen::Vector3d::UnitY();
  }
  const bool is_upright = forward.z() <= std::sin(M_PI_4) * forward.norm() || up.norm() == 0.0;
  return is_upright ? Eigen::Vector3d::UnitZ().eval() : up.normalized().eval();
}

/// Unit vector from the centre to the viewpoint.
Eigen::Vector3d direction_to_viewer(const Scene& scene, const Eigen::Vector3d& centre,
                                    const Eigen::Vector3d& up, bool has_table) {
  const Points positions = camera_positions(scene);
  const Eigen::Vector3d to_camera =
      positions.empty() ? Eigen::Vector3d(-1.0, 0.0, 0.5) : (mean(positions) - centre).eval();
  Eigen::Vector3d horizontal = to_camera - to_camera.dot(up) * up;
  // Degenerate from vertically above: use the robot's side.
  if (horizontal.norm() < 0.01) horizontal = -Eigen::Vector3d::UnitX();
  const double camera_elevation = std::atan2(to_camera.dot(up), horizontal.norm());
  const double elevation =
      has_table ? kTableElevation : std::clamp(camera_elevation, kMinElevation, kTableElevation);
  return std::cos(elevation) * horizontal.normalized() + std::sin(elevation) * up;
}

/// Upright camera axes, looking along -`to_viewer`.
Eigen::Matrix3d axes_of_view(const Eigen::Vector3d& to_viewer, const Eigen::Vector3d& up) {
  Eigen::Matrix3d R_base_view;
  const Eigen::Vector3d forward = -to_viewer;
  const Eigen::Vector3d right = forward.cross(up).normalized();
  R_base_view << right, forward.cross(right), forward;
  return R_base_view;
}

}  // namespace

View choose_view(const Scene& scene, int width, int height) {
  const Eigen::Vector3d up = up_direction(scene);
  Points points;
  if (up == Eigen::Vector3d::UnitZ()) points = points_of_interest(scene);
  const bool has_table = !points.empty();
  if (!has_table) points = points_of_bulk(scene.mesh_base);
  const Eigen::Matrix3d R_base_view =
      axes_of_view(direction_to_viewer(scene, mean(points), up, has_table), up);

  View view;
  CameraModel& camera = view.camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.5 * width / std::tan(0.5 * kFieldOfView);
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  const double slope_x = kFillFraction * 0.5 * width / camera.fx;
  const double slope_y = kFillFraction * 0.5 * height / camera.fy;

  // For each side of the image the tightest frustum plane through the points; the planes of
  // opposite sides intersect at the viewpoint.
  double left = -INFINITY, right = -INFINITY, top = -INFINITY, bottom = -INFINITY;
  double nearest = INFINITY;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = R_base_view.transpose() * point;
    left = std::max(left, -p.x() - slope_x * p.z());
    right = std::max(right, p.x() - slope_x * p.z());
    top = std::max(top, -p.y() - slope_y * p.z());
    bottom = std::max(bottom, p.y() - slope_y * p.z());
    nearest = std::min(nearest, p.z());
  }
  const double behind_x = -(left + right) / (2.0 * slope_x);
  const double behind_y = -(top + bottom) / (2.0 * slope_y);
  const double z = std::min({behind_x, behind_y, nearest - kMinDistance});
  const Eigen::Vector3d viewpoint(0.5 * (right - left), 0.5 * (bottom - top), z);
  view.T_base_view = Pose(Eigen::Quaterniond(R_base_view), R_base_view * viewpoint);
  return view;
}

}  // namespace pcavr
