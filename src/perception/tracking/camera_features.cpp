// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_features.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace pcavr::tracking {
namespace {

// The image is divided into tiles, each with its own maximum: a moving object may have the best
// corners, but does not get all of them.
constexpr int kTile = 128;           // [px]
constexpr int kCornersPerTile = 12;  // 240 in an image of 640x480
constexpr int kBucket = 16;          // [px]; one corner in each, so that windows overlap little
constexpr int kBlock = 5;            // [px]; window of the corner score

// Threshold on the rms gradient along a corner's weaker direction, so that noise of two or three
// gray levels is not detected as a corner [gray levels / px].
constexpr double kMinGradient = 3.0;

const cv::Size kWindow(17, 17);  // [px]
constexpr int kMaxLevel = 3;     // an eighth of the resolution: displacements to some 60 px

bool is_smooth(const CellGrid& grid, const Surface& surface, const cv::Point& pixel) {
  const int x = pixel.x / grid.pixels;
  const int y = pixel.y / grid.pixels;
  return x < grid.width() && y < grid.height() &&
         !surface.normals[static_cast<std::size_t>(y * grid.width() + x)].isZero();
}

struct Corner {
  float strength = 0.0F;
  cv::Point pixel;
};

/// The strongest corner of each bucket of a tile, where the surface is smooth.
std::vector<Corner> bucket_corners(const cv::Mat& strength, const cv::Rect& tile,
                                   float min_strength, const CellGrid& grid,
                                   const Surface& surface) {
  std::vector<Corner> corners;
  for (int y = tile.y; y < tile.br().y; y += kBucket) {
    for (int x = tile.x; x < tile.br().x; x += kBucket) {
      const cv::Rect bucket = cv::Rect(x, y, kBucket, kBucket) & tile;
      double best = 0.0;
      cv::Point at;
      cv::minMaxLoc(strength(bucket), nullptr, &best, nullptr, &at);
      at += bucket.tl();
      if (best < double{min_strength} || !is_smooth(grid, surface, at)) continue;
      corners.push_back({static_cast<float>(best), at});
    }
  }
  return corners;
}

}  // namespace

cv::Mat to_gray_mat(const ColorImage& color) {
  // cv::Mat has no const data pointer; the pixels are only read.
  const cv::Mat rgb(color.height(), color.width(), CV_8UC3,
                    const_cast<Rgb8*>(color.pixels().data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

Pyramid make_pyramid(const cv::Mat& gray, bool with_derivatives) {
  Pyramid pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, kWindow, kMaxLevel, with_derivatives);
  return pyramid;
}

std::vector<cv::Point2f> find_corners(const cv::Mat& gray, const CellGrid& grid,
                                      const Surface& surface) {
  cv::Mat strength;
  cv::cornerMinEigenVal(gray, strength, kBlock);
  // OpenCV scales Sobel's gradient (8 for one gray level a pixel) by 1 / (4 * block * 255), and
  // sums its squares over the block.
  const double gradient = kMinGradient * 8.0 / (4.0 * kBlock * 255.0);
  const auto min_strength = static_cast<float>(kBlock * kBlock * gradient * gradient);
  std::vector<cv::Point2f> corners;
  for (int y = 0; y < gray.rows; y += kTile) {
    for (int x = 0; x < gray.cols; x += kTile) {
      const cv::Rect tile = cv::Rect(x, y, kTile, kTile) & cv::Rect({0, 0}, gray.size());
      std::vector<Corner> found = bucket_corners(strength, tile, min_strength, grid, surface);
      const auto kept = std::min<std::size_t>(found.size(), kCornersPerTile);
      std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept),
                        found.end(),
                        [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
      for (std::size_t i = 0; i < kept; ++i) corners.emplace_back(found[i].pixel);
    }
  }
  return corners;
}

std::vector<Landmark> make_landmarks(const std::vector<cv::Point2f>& corners, const CellGrid& grid,
                                     const Surface& surface, const CameraModel& camera,
                                     const Pose& T_depth_color) {
  std::vector<Landmark> landmarks;
  for (const cv::Point2f& corner : corners) {
    const auto p_color = point_at(grid, surface, camera, Eigen::Vector2d(corner.x, corner.y));
    if (p_color) landmarks.push_back({corner, T_depth_color * *p_color});
  }
  return landmarks;
}

std::vector<FeatureMatch> track_landmarks(const Pyramid& model,
                                          const std::vector<Landmark>& landmarks,
                                          const Pyramid& frame, const Pose& T_model_color,
                                          const CameraModel& camera) {
  const Pose T_color_model = T_model_color.inverse();
  std::vector<cv::Point2f> before;
  std::vector<cv::Point2f> after;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    const Eigen::Vector3d p = T_color_model * landmark.p_model;
    if (p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (!camera.contains(pixel)) continue;
    before.push_back(landmark.pixel);
    after.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    indices.push_back(i);
  }
  std::vector<FeatureMatch> matches;
  if (before.empty()) return matches;
  std::vector<std::uint8_t> found;
  cv::calcOpticalFlowPyrLK(
      model, frame, before, after, found, cv::noArray(), kWindow, kMaxLevel,
      cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02),
      cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Eigen::Vector2d pixel(after[i].x, after[i].y);
    if (found[i] == 0 || !camera.contains(pixel)) continue;
    FeatureMatch match{landmarks[indices[i]].p_model, camera.normalise(pixel), indices[i]};
    (void)camera.distortion.distort(match.ray, &match.lens_jacobian);
    matches.push_back(match);
  }
  return matches;
}

}  // namespace pcavr::tracking
