// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_features.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace pcavr::tracking {
namespace {

constexpr int kMostCorners = 250;
constexpr double kCornerQuality = 0.01;  // of the strongest corner's smaller eigenvalue
constexpr double kCornerSpacing = 14.0;  // [px]; windows overlap little
const cv::Size kWindow(17, 17);          // [px]
constexpr int kTopLevel = 3;             // an eighth of the resolution: offsets to some 60 px

}  // namespace

cv::Mat gray_of(const ColorImage& color) {
  // OpenCV has no read-only header; the pixels are only read.
  const cv::Mat rgb(color.height(), color.width(), CV_8UC3,
                    const_cast<Rgb8*>(color.pixels().data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

Pyramid make_pyramid(const cv::Mat& gray, bool with_derivatives) {
  Pyramid pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, kWindow, kTopLevel, with_derivatives);
  return pyramid;
}

std::vector<cv::Point2f> find_corners(const cv::Mat& gray, const CellGrid& grid,
                                      const Surface& surface) {
  cv::Mat mask = cv::Mat::zeros(gray.size(), CV_8U);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (surface.normals[static_cast<std::size_t>(y * grid.width() + x)].isZero()) continue;
      mask(cv::Rect(x * grid.pixels, y * grid.pixels, grid.pixels, grid.pixels)) = 255;
    }
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, kMostCorners, kCornerQuality, kCornerSpacing, mask, 5);
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

std::vector<FeatureMatch> find_landmarks(const Pyramid& model,
                                         const std::vector<Landmark>& landmarks,
                                         const Pyramid& frame, const Pose& T_model_color,
                                         const CameraModel& camera) {
  const Pose T_color_model = T_model_color.inverse();
  std::vector<cv::Point2f> before;
  std::vector<cv::Point2f> after;
  std::vector<const Landmark*> sought;
  for (const Landmark& landmark : landmarks) {
    const Eigen::Vector3d p = T_color_model * landmark.p_model;
    if (p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (!camera.contains(pixel)) continue;
    before.push_back(landmark.pixel);
    after.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    sought.push_back(&landmark);
  }
  std::vector<FeatureMatch> matches;
  if (before.empty()) return matches;
  std::vector<std::uint8_t> found;
  cv::calcOpticalFlowPyrLK(
      model, frame, before, after, found, cv::noArray(), kWindow, kTopLevel,
      cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02),
      cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  for (std::size_t i = 0; i < sought.size(); ++i) {
    const Eigen::Vector2d pixel(after[i].x, after[i].y);
    if (found[i] == 0 || !camera.contains(pixel)) continue;
    matches.push_back({sought[i]->p_model, camera.normalise(pixel)});
  }
  return matches;
}

}  // namespace pcavr::tracking
