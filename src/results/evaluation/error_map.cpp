// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "error_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "pcavr/base/geometry/image_scaling.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/preview_parts.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// [m] Ends of the scale; the first that most of the mesh is within, with this margin.
constexpr std::array<double, 5> kScaleEnds = {0.001, 0.002, 0.005, 0.010, 0.020};
constexpr double kScaleMargin = 1.2;
constexpr std::size_t kVertexGrain = 1024;
constexpr int kPictureWidth = 960, kPictureHeight = 600;  // [px]
constexpr int kPictureSupersampling = 2;                  // along each axis
/// Focal length over the picture's width: an angle of 53 degrees across.
constexpr double kFocalShare = 1.0;
/// Share of the mesh's points that the picture shows, in kFilledShare of it: outliers would shrink
/// the rest.
constexpr double kShownShare = 0.97;
constexpr double kFilledShare = 0.85;
/// Slope of the line of sight, at least: tables are seen from above.
constexpr double kMinElevation = 0.5;
constexpr std::uint8_t kMeshId = 1;

/// viridis [Smith & van der Walt 2015], ordered in lightness for every kind of colour vision.
constexpr std::array<Rgb8, 5> kScale = {
    {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};

double scale_end(double error_p95) {
  const auto end = std::find_if(kScaleEnds.begin(), kScaleEnds.end() - 1,
                                [&](double one) { return kScaleMargin * error_p95 <= one; });
  return *end;
}

/// `share` of the scale, from 0 to 1.
Rgb8 color_of(float share_of_scale) {
  const float at = std::clamp(share_of_scale, 0.0F, 1.0F) * (kScale.size() - 1);
  const auto lower = std::min(static_cast<std::size_t>(at), kScale.size() - 2);
  const float share = at - static_cast<float>(lower);
  const auto mix = [&](std::uint8_t Rgb8::*channel) {
    const float a = kScale[lower].*channel, b = kScale[lower + 1].*channel;
    return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

double quantile_of(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Middle of the box around most of the mesh.
Eigen::Vector3d middle_of(const TriangleMesh& mesh_base) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(mesh_base.vertices.size());
    for (const Eigen::Vector3f& v : mesh_base.vertices) values.push_back(v[axis]);
    middle[axis] =
        0.5 * (quantile_of(values, 1.0 - kShownShare) + quantile_of(values, kShownShare));
  }
  return middle;
}

/// Direction from the middle towards the cameras.
Eigen::Vector3d direction_to(const std::vector<Pose>& T_base_camera,
                             const Eigen::Vector3d& middle) {
  Eigen::Vector3d direction(-0.6, -1.0, 0.0);
  if (!T_base_camera.empty()) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Pose& pose : T_base_camera) sum += pose.translation();
    const Eigen::Vector3d mean = sum / static_cast<double>(T_base_camera.size()) - middle;
    if (mean.head<2>().norm() > 1e-3) direction = mean;
  }
  direction.z() = std::max(direction.z(), kMinElevation * direction.head<2>().norm());
  return direction.normalized();
}

/// [m] Distance from the middle at which most of the mesh is in the picture; `axes`: right, down,
/// forward.
double distance_for(const TriangleMesh& mesh_base, const Eigen::Vector3d& middle,
                    const Eigen::Matrix3d& axes, const CameraModel& camera) {
  std::vector<double> distances;
  distances.reserve(mesh_base.vertices.size());
  for (const Eigen::Vector3f& v : mesh_base.vertices) {
    const Eigen::Vector3d p = axes.transpose() * (v.cast<double>() - middle);
    const double slope = 2.0 / kFilledShare *
                         std::max(std::abs(p.x()) * camera.fx / camera.width,
                                  std::abs(p.y()) * camera.fy / camera.height);
    distances.push_back(slope - p.z());
  }
  return std::max(quantile_of(distances, kShownShare), 1e-3);
}

View view_of(const TriangleMesh& mesh_base, const std::vector<Pose>& T_base_camera) {
  const Eigen::Vector3d middle = middle_of(mesh_base);
  const Eigen::Vector3d back = direction_to(T_base_camera, middle);
  CameraModel camera{.width = kPictureSupersampling * kPictureWidth,
                     .height = kPictureSupersampling * kPictureHeight};
  camera.fx = camera.fy = kFocalShare * camera.width;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  Eigen::Matrix3d axes;
  axes.col(2) = -back;
  axes.col(0) = axes.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {camera, Pose(Eigen::Quaterniond(axes),
                       middle + distance_for(mesh_base, middle, axes, camera) * back)};
}

void draw_legend(ColorImage& picture, double max_error) {
  constexpr double kBottom = 14.0, kRight = 60.0, kStep = 90.0;  // [px]
  for (std::size_t i = 0; i < kScale.size(); ++i) {
    const double error =
        1e3 * max_error * static_cast<double>(i) / static_cast<double>(kScale.size() - 1);
    const bool is_last = i + 1 == kScale.size();
    const double x = kPictureWidth - kRight - kStep * static_cast<double>(kScale.size() - 1 - i);
    draw_label(picture, {x, kPictureHeight - kBottom},
               fmt::format("{:.3g}{} mm", error, is_last ? "+" : ""), kScale[i]);
  }
}

ColorImage picture_of(const TriangleMesh& mesh_base, const std::vector<Pose>& T_base_camera,
                      double max_error, Parallelism parallelism) {
  const View view = view_of(mesh_base, T_base_camera);
  Canvas canvas(view.camera.width, view.camera.height);
  draw_background(canvas);
  const Eigen::Vector3f to_light =
      (view.T_base_view.rotation() * Eigen::Vector3d(-0.4, -0.8, -0.7)).normalized().cast<float>();
  draw_mesh(
      canvas, view, mesh_base, kMeshId,
      [&](const Eigen::Vector3f& color, const Eigen::Vector3f& normal) {
        return Eigen::Vector3f(color * (0.8F + 0.2F * std::max(0.0F, normal.dot(to_light))));
      },
      parallelism);
  draw_contours(canvas, kMeshId + 1);
  ColorImage picture = halved(canvas.color);
  draw_legend(picture, max_error);
  return picture;
}

}  // namespace

ErrorMap error_map(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                   const std::vector<Pose>& T_base_camera, double error_p95,
                   Parallelism parallelism) {
  ErrorMap map{mesh_base, scale_end(error_p95), {}};
  TriangleMesh& mesh = map.mesh_base;
  if (mesh.vertices.empty() || truth_base.triangles.empty()) return map;
  const SurfaceQuery truth(truth_base);
  const auto max_error = static_cast<float>(map.max_error);
  mesh.colors.resize(mesh.vertices.size());
  parallel_for(parallelism, mesh.vertices.size(), kVertexGrain,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const auto closest = truth.closest(mesh.vertices[i], max_error);
                   mesh.colors[i] = color_of(closest ? closest->distance / max_error : 1.0F);
                 }
               });
  if (mesh.normals.empty()) compute_vertex_normals(mesh);
  Expected<std::string> jpeg =
      encode_color(picture_of(mesh, T_base_camera, map.max_error, parallelism), 90);
  if (jpeg) map.jpeg = *std::move(jpeg);
  return map;
}

}  // namespace pcavr
