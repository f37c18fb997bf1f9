// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

// Tangents of a depth camera's half angles of view, 60 x 46 degrees in all; the scene does not
// store the camera model.
constexpr double kHalfWidth = 0.577;
constexpr double kHalfHeight = 0.424;
constexpr std::size_t kMaxViews = 64;  ///< of the camera, evenly spaced: they determine what it saw
/// Share of the number of views that see the best-seen points: points that fewer views see are
/// around what matters.
constexpr double kMinViewShare = 0.5;

std::vector<Pose> sampled_views(const Scene& scene) {
  const std::vector<TimedPose>& poses = scene.camera_trajectory.poses();
  std::vector<Pose> views;
  const std::size_t stride = std::max<std::size_t>(1, (poses.size() + kMaxViews - 1) / kMaxViews);
  for (std::size_t i = 0; i < poses.size(); i += stride) views.push_back(poses[i].pose.inverse());
  return views;
}

bool is_in_view(const Pose& T_camera_base, const Eigen::Vector3d& p_base) {
  const Eigen::Vector3d p = T_camera_base * p_base;
  return p.z() > 0.0 && std::abs(p.x()) < kHalfWidth * p.z() &&
         std::abs(p.y()) < kHalfHeight * p.z();
}

/// Share of the camera's views that contain a point.
double view_share(const std::vector<Pose>& views, const Eigen::Vector3d& p_base) {
  if (views.empty()) return 1.0;
  const auto count = std::count_if(views.begin(), views.end(), [&](const Pose& T_camera_base) {
    return is_in_view(T_camera_base, p_base);
  });
  return static_cast<double>(count) / static_cast<double>(views.size());
}

/// The points that the camera looked at: in at least half as many views as the best-seen ones.
Points looked_at(const Points& points, const std::vector<Pose>& views) {
  std::vector<double> shares;
  for (const Eigen::Vector3d& point : points) shares.push_back(view_share(views, point));
  std::vector<double> sorted = shares;
  const auto best =
      sorted.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(sorted.size()));
  if (best == sorted.end()) return points;
  std::nth_element(sorted.begin(), best, sorted.end());
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (shares[i] >= kMinViewShare * *best) kept.push_back(points[i]);
  }
  return kept;
}

Points sampled_vertices(const TriangleMesh& mesh) {
  constexpr std::size_t kMaxFramedPoints = 20'000;  // a sample determines the view
  Points points;
  const std::size_t stride = mesh.vertices.size() / kMaxFramedPoints + 1;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += stride) {
    points.push_back(mesh.vertices[i].cast<double>());
  }
  return points;
}

/// Twice the area long.
Eigen::Vector3d area_normal(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
  return (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a);
}

/// Whether a tenth or more of what the camera looked at lies on the support planes or above them.
bool has_bulk_on(const Scene& scene) {
  constexpr double kMinOn = 0.1;
  constexpr double kMaxAbove = 0.5;   // [m]
  constexpr double kMaxBelow = 0.02;  // [m]
  const Points points = looked_at(sampled_vertices(scene.mesh_base), sampled_views(scene));
  const auto is_on = [&](const Eigen::Vector3d& p) {
    return std::any_of(scene.support_planes.begin(), scene.support_planes.end(),
                       [&](const SupportPlane& plane) {
                         Eigen::AlignedBox3d box;
                         for (const auto& corner : plane.outline_base) box.extend(corner);
                         box.min().z() -= kMaxBelow;
                         box.max().z() += kMaxAbove;
                         return box.contains(p);
                       });
  };
  const auto on = std::count_if(points.begin(), points.end(), is_on);
  return static_cast<double>(on) >= kMinOn * static_cast<double>(points.size());
}

/// Corners of the objects' bounding boxes, and outlines of the support planes. Empty without
/// objects where the planes are not what the camera looked at: scraps of a floor below a shelf.
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
  if (scene.objects.empty() && !points.empty() && !has_bulk_on(scene)) return {};
  return points;
}

/// Vertices of the mesh that the camera looked at, without outliers: inside the 2 % to 98 %
/// quantiles along each axis.
Points points_of_bulk(const Scene& scene) {
  constexpr double kTail = 0.02;  // fraction on each side
  const Points sampled = looked_at(sampled_vertices(scene.mesh_base), sampled_views(scene));
  if (sampled.empty()) return {Eigen::Vector3d::Zero()};
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  std::vector<double> coordinates(sampled.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(sampled.begin(), sampled.end(), coordinates.begin(),
                   [&](const Eigen::Vector3d& vertex) { return vertex[axis]; });
    const auto quantile = [&](double fraction) {
      const auto index =
          static_cast<std::ptrdiff_t>(fraction * static_cast<double>(coordinates.size() - 1));
      std::nth_element(coordinates.begin(), coordinates.begin() + index, coordinates.end());
      return coordinates[static_cast<std::size_t>(index)];
    };
    low[axis] = quantile(kTail);
    high[axis] = quantile(1.0 - kTail);
  }
  const Eigen::AlignedBox3d box(low, high);
  Points points;
  for (const Eigen::Vector3d& point : sampled) {
    if (box.contains(point)) points.push_back(point);
  }
  return points.empty() ? Points{box.center()} : points;
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

/// Share of the mesh's area whose normal is within 10 degrees of a line.
double level_share(const TriangleMesh& mesh, const Eigen::Vector3d& up) {
  const double min_cosine = std::cos(10.0 * M_PI / 180.0);
  double level = 0.0;
  double all = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d normal = area_normal(mesh, t);
    all += normal.norm();
    if (std::abs(normal.dot(up)) > min_cosine * normal.norm()) level += normal.norm();
  }
  return all > 0.0 ? level / all : 0.0;
}

/// The mean normal of the surfaces that face within 30 degrees of `near`.
Eigen::Vector3d facing_normal(const TriangleMesh& mesh, const Eigen::Vector3d& near) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d normal = area_normal(mesh, t);
    if (normal.dot(near) > std::cos(M_PI / 6.0) * normal.norm()) sum += normal;
  }
  return sum.norm() > 0.0 ? sum.normalized() : near;
}

/// Opposite to gravity: base's z axis, where surfaces are level in it, or none are in the direction
/// that was up in the camera's pictures; and that, with the surfaces that face it, elsewhere.
Eigen::Vector3d level_direction(const Scene& scene, const Eigen::Vector3d& camera_up) {
  Eigen::Vector3d up = camera_up;
  for (int i = 0; i < 3; ++i) up = facing_normal(scene.mesh_base, up);
  constexpr double kMinShare = 0.05;  // of the area: a table in a room
  const double found = level_share(scene.mesh_base, up);
  const bool is_better =
      found > kMinShare && found > 2.0 * level_share(scene.mesh_base, Eigen::Vector3d::UnitZ());
  return is_better ? up : Eigen::Vector3d::UnitZ();
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

// Up as in level_direction. If the camera looks at base's zenith all the time, the world frame is
// arbitrary, and up is that of its pictures.
Eigen::Vector3d up_direction(const Scene& scene) {
  Eigen::Vector3d forward = Eigen::Vector3d::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const TimedPose& timed : scene.camera_trajectory.poses()) {
    forward += timed.pose.rotation() * Eigen::Vector3d::UnitZ();
    up -= timed.pose.rotation() * Eigen::Vector3d::UnitY();
  }
  const bool is_upright = forward.z() <= std::sin(M_PI_4) * forward.norm() || up.norm() == 0.0;
  if (!is_upright) return up.normalized();
  // A camera that looks steeply down shows nothing of up in its pictures.
  const bool looks_down = forward.z() < -std::sin(M_PI_4) * forward.norm();
  if (looks_down || up.norm() == 0.0) return Eigen::Vector3d::UnitZ();
  return level_direction(scene, up.normalized());
}

View choose_view(const Scene& scene, int width, int height) {
  const Eigen::Vector3d up = up_direction(scene);
  Points points;
  if (up == Eigen::Vector3d::UnitZ()) points = points_of_interest(scene);
  const bool has_table = !points.empty();
  if (!has_table) points = points_of_bulk(scene);
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

  // The tightest frustum plane through the points for each side of the image; the planes of
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
