// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/recordings/cloud/pinhole_fit.hpp"
#include "pcavr/recordings/cloud/range_image.hpp"

#include "recordings/cloud/ray_grid.hpp"

namespace pcavr {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t kMinRangePoints = 100;
/// Tangent of the largest angle from the axis of a single camera, 60 degrees.
const float kMaxTangent = std::sqrt(3.0F);
/// Share of the points that a single camera must see; the others may be outliers.
constexpr double kMinShareInside = 0.995;
/// Share of the points below which a face of the cube is left out.
constexpr double kMinShareOfFace = 0.005;
constexpr std::size_t kSpacingSamples = 1000;
/// Neighbours for the density of rays. On a grid the twelfth is two steps away, as by the density:
/// sqrt(12 / pi) is 1.95.
constexpr int kNeighbours = 12;
constexpr double kMaxPixels = 4e6;
constexpr double kMinFocalLength = 50.0;  // [px]

/// Rays on the plane z = 1 of a camera: its points in front, within `max_tangent`.
std::vector<Eigen::Vector2f> rays_in(const Points& points, const Pose& T_sensor_camera,
                                     float max_tangent) {
  const Eigen::Matrix3f R = T_sensor_camera.rotation_matrix().transpose().cast<float>();
  std::vector<Eigen::Vector2f> rays;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = R * point;
    if (!(p.z() > 0.0F)) continue;
    const Eigen::Vector2f ray = p.head<2>() / p.z();
    if (ray.cwiseAbs().maxCoeff() <= max_tangent) rays.push_back(ray);
  }
  return rays;
}

std::size_t count_points(std::span<const Points> clouds) {
  std::size_t count = 0;
  for (const Points& points : clouds) {
    count += static_cast<std::size_t>(std::count_if(
        points.begin(), points.end(), [](const Eigen::Vector3f& p) { return !std::isnan(p.x()); }));
  }
  return count;
}

std::vector<Eigen::Vector2f> rays_of_all(std::span<const Points> clouds,
                                         const Pose& T_sensor_camera, float max_tangent) {
  std::vector<Eigen::Vector2f> rays;
  for (const Points& points : clouds) {
    const auto more = rays_in(points, T_sensor_camera, max_tangent);
    rays.insert(rays.end(), more.begin(), more.end());
  }
  return rays;
}

/// The median distance of neighbouring rays in the plane z = 1, from the density around samples.
double spacing_of(const std::vector<Eigen::Vector2f>& rays) {
  if (rays.size() <= kNeighbours) return 0.0;
  auto plane = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  plane->reserve(rays.size());
  for (const Eigen::Vector2f& ray : rays) plane->push_back({ray.x(), ray.y(), 0.0F});
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(plane);
  std::vector<double> spacings;
  pcl::Indices indices;
  std::vector<float> squares;
  const std::size_t step = rays.size() / kSpacingSamples + 1;
  for (std::size_t i = 0; i < rays.size(); i += step) {
    // The first neighbour is the sample itself.
    tree.nearestKSearch((*plane)[i], kNeighbours + 1, indices, squares);
    spacings.push_back(
        std::sqrt(static_cast<double>(squares.back()) * std::numbers::pi / kNeighbours));
  }
  return median(std::move(spacings));
}

/// The camera with that ray spacing which sees the rays.
CameraModel camera_around(const std::vector<Eigen::Vector2f>& rays, double spacing) {
  Eigen::AlignedBox2f box;
  for (const Eigen::Vector2f& ray : rays) box.extend(ray);
  const Eigen::Vector2d extent = box.sizes().cast<double>();
  double focal_length = std::max(kMinFocalLength, 1.0 / std::max(spacing, 1e-4));
  const double area = extent.prod() * focal_length * focal_length;
  if (area > kMaxPixels) focal_length *= std::sqrt(kMaxPixels / area);
  // Two pixels of margin: the last rays keep their neighbours.
  constexpr double kMargin = 2.0;
  const auto size = [&](double tangents) {
    return std::max(16, static_cast<int>(std::ceil(tangents * focal_length + 2.0 * kMargin)));
  };
  CameraModel camera{.width = size(extent.x()), .height = size(extent.y())};
  camera.fx = camera.fy = focal_length;
  camera.cx = kMargin - static_cast<double>(box.min().x()) * focal_length;
  camera.cy = kMargin - static_cast<double>(box.min().y()) * focal_length;
  return camera;
}

/// The six faces of a cube around the sensor.
std::vector<Pose> cube_faces() {
  const Eigen::Quaterniond quarter(
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()));
  std::vector<Pose> faces;
  // The faces turn about the vertical axis of a robot's sensor, starting forward; then come up and
  // down.
  Pose face = sensor_camera_pose(SensorAxes::robot);
  for (int i = 0; i < 4; ++i) {
    faces.push_back(face);
    face = face * Pose(quarter, Eigen::Vector3d::Zero());
  }
  for (const double angle : {0.5, -0.5}) {
    const Eigen::Quaterniond tilt(
        Eigen::AngleAxisd(angle * std::numbers::pi, Eigen::Vector3d::UnitX()));
    faces.push_back(face * Pose(tilt, Eigen::Vector3d::Zero()));
  }
  return faces;
}

std::optional<RangeCameras> single_camera(std::span<const Points> clouds, std::size_t count) {
  for (const SensorAxes axes : {SensorAxes::optical, SensorAxes::robot, SensorAxes::graphics}) {
    const Pose T_sensor_camera = sensor_camera_pose(axes);
    const auto rays = rays_of_all(clouds, T_sensor_camera, kMaxTangent);
    if (static_cast<double>(rays.size()) < kMinShareInside * static_cast<double>(count)) continue;
    // The grid is searched in one cloud: the others have nearly the same rays.
    const auto first = rays_in(clouds.front(), T_sensor_camera, kMaxTangent);
    if (const std::optional<CameraModel> grid = find_ray_grid(first, rays)) {
      return RangeCameras{*grid, {T_sensor_camera}, 1.0 / grid->fx, true};
    }
    const double spacing = spacing_of(first);
    return RangeCameras{camera_around(rays, spacing), {T_sensor_camera}, spacing};
  }
  return std::nullopt;
}

RangeCameras cube_cameras(std::span<const Points> clouds, std::size_t count) {
  RangeCameras cameras;
  std::vector<Eigen::Vector2f> fullest;
  for (const Pose& face : cube_faces()) {
    const auto share = static_cast<double>(rays_of_all(clouds, face, 1.0F).size());
    if (share < kMinShareOfFace * static_cast<double>(count)) continue;
    cameras.T_sensor_camera.push_back(face);
    auto rays = rays_in(clouds.front(), face, 1.0F);
    if (rays.size() > fullest.size()) fullest = std::move(rays);
  }
  cameras.ray_spacing = spacing_of(fullest);
  const std::vector<Eigen::Vector2f> corners = {{-1.0F, -1.0F}, {1.0F, 1.0F}};
  cameras.camera = camera_around(corners, cameras.ray_spacing);
  return cameras;
}

}  // namespace

RangeCameras choose_range_cameras(std::span<const Points> clouds_sensor) {
  const std::size_t count = count_points(clouds_sensor);
  if (count < kMinRangePoints) return {};
  if (std::optional<RangeCameras> single = single_camera(clouds_sensor, count)) return *single;
  return cube_cameras(clouds_sensor, count);
}

}  // namespace pcavr
