// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"

namespace pcavr::test {

inline CameraModel a_camera(double k1 = 0.0) {
  return {.width = 640,
          .height = 480,
          .fx = 525,
          .fy = 525,
          .cx = 319.5,
          .cy = 239.5,
          .distortion = {k1, 0, 0, 0, 0}};
}

struct RenderedTag {
  MarkerId id;
  double size = 0.0;
  Pose T_camera_marker;
};

/// The tag's upright face toward the camera: tilted by `tilt` about an axis in its plane that lies
/// at `azimuth`, spun by `spin` about its normal.
inline Pose facing(const Eigen::Vector3d& p_camera, double tilt, double azimuth, double spin) {
  const Eigen::AngleAxisd half_turn(M_PI, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd tilted(tilt, Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0));
  const Eigen::AngleAxisd spun(spin, Eigen::Vector3d::UnitZ());
  return Pose(Eigen::Quaterniond(half_turn * tilted * spun), p_camera);
}

/// Pixel of each corner, exactly.
inline std::array<Eigen::Vector2d, 4> true_corners(const RenderedTag& tag,
                                                   const CameraModel& camera) {
  std::array<Eigen::Vector2d, 4> corners;
  const auto model = tag_corners(tag.size);
  for (std::size_t i = 0; i < 4; ++i) corners[i] = camera.project(tag.T_camera_marker * model[i]);
  return corners;
}

/// Grey value of the ray through (x, y, 1): paper around the cells, one cell wide; -1 outside it.
inline double grey_of_ray(const RenderedTag& tag, const TagPicture& picture,
                          const Eigen::Vector2d& at) {
  const Eigen::Matrix3d R = tag.T_camera_marker.rotation_matrix();
  const Eigen::Vector3d& centre = tag.T_camera_marker.translation();
  const Eigen::Vector3d ray(at.x(), at.y(), 1.0);
  const double z = R.col(2).dot(centre) / R.col(2).dot(ray);
  const Eigen::Vector3d p_marker = R.transpose() * (z * ray - centre);
  const double cell = tag.size / (picture.cells - 2 * picture.border);
  const int column = static_cast<int>(std::floor(p_marker.x() / cell + 0.5 * picture.cells));
  const int row = static_cast<int>(std::floor(0.5 * picture.cells - p_marker.y() / cell));
  if (column < -1 || row < -1 || column > picture.cells || row > picture.cells) return -1.0;
  const bool is_paper = column < 0 || row < 0 || column >= picture.cells || row >= picture.cells;
  if (is_paper) return 210.0;
  return picture.is_white[static_cast<std::size_t>(row * picture.cells + column)] ? 210.0 : 35.0;
}

/// Separable Gaussian blur with standard deviation `sigma` [px].
inline Image<float> blurred(const Image<float>& image, double sigma) {
  std::vector<double> kernel;
  for (int i = -3; i <= 3; ++i) kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  double sum = 0.0;
  for (const double k : kernel) sum += k;
  Image<float> from = image;
  for (const bool across : {true, false}) {
    Image<float> to(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        double value = 0.0;
        for (int i = -3; i <= 3; ++i) {
          const int u = std::clamp(across ? x + i : x, 0, image.width() - 1);
          const int v = std::clamp(across ? y : y + i, 0, image.height() - 1);
          value += kernel[static_cast<std::size_t>(i + 3)] * static_cast<double>(from(u, v));
        }
        to(x, y) = static_cast<float>(value / sum);
      }
    }
    from = to;
  }
  return from;
}

/// Tags on a grey background: 5 x 5 rays per pixel, blur of 0.55 px, noise of 2 grey levels.
inline GrayImage render_tags(const std::vector<RenderedTag>& tags, const CameraModel& camera,
                             std::uint64_t seed = 1) {
  constexpr int kRays = 5;
  constexpr double kBackground = 120.0;
  Image<float> sum(camera.width, camera.height, static_cast<float>(kBackground));
  for (const RenderedTag& tag : tags) {
    const TagPicture picture = *tag_picture(tag.id.family, tag.id.id);
    // Bounding box of the paper in the image, with a margin.
    RenderedTag paper = tag;
    paper.size *= 1.3 * (picture.cells + 2) / (picture.cells - 2 * picture.border);
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : true_corners(paper, camera)) box.extend(corner);
    for (int y = std::max(0, int(box.min().y())); y <= std::min(camera.height - 1.0, box.max().y());
         ++y) {
      for (int x = std::max(0, int(box.min().x()));
           x <= std::min(camera.width - 1.0, box.max().x()); ++x) {
        double value = 0.0;
        for (int i = 0; i < kRays * kRays; ++i) {
          const Eigen::Vector2d pixel(x + (i % kRays + 0.5) / kRays - 0.5,
                                      y + (i / kRays + 0.5) / kRays - 0.5);
          const double grey = grey_of_ray(tag, picture, camera.normalise(pixel));
          value += grey < 0.0 ? static_cast<double>(sum(x, y)) : grey;
        }
        sum(x, y) = static_cast<float>(value / (kRays * kRays));
      }
    }
  }
  const Image<float> smooth = blurred(sum, 0.55);
  GrayImage image(camera.width, camera.height);
  Random random(seed);
  for (std::size_t i = 0; i < image.pixels().size(); ++i) {
    const double value = static_cast<double>(smooth.pixels()[i]) + 2.0 * random.normal();
    image.pixels()[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
  return image;
}

}  // namespace pcavr::test
