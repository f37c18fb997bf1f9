// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/board_pose.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>

namespace pcavr {
namespace {

/// Of the image's width: of the widest and the longest usual lens, and of one between.
constexpr double kMinFocal = 0.25, kMaxFocal = 8.0, kUsualFocal = 1.0;

}  // namespace

std::vector<Eigen::Vector3d> points_of(const BoardView& view,
                                       const std::vector<Eigen::Vector3d>& board) {
  std::vector<Eigen::Vector3d> points;
  for (const std::size_t id : view.ids) points.push_back(board[id]);
  return points;
}

std::optional<Pose> board_pose(const CameraModel& camera,
                               const std::vector<Eigen::Vector3d>& points,
                               const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (std::size_t i = 0; i < points.size(); ++i) {
    object.emplace_back(points[i].x(), points[i].y(), points[i].z());
    const Eigen::Vector2d p = camera.normalise(pixels[i]);
    image.emplace_back(p.x(), p.y());
  }
  const cv::Matx33d K = cv::Matx33d::eye();
  std::vector<cv::Mat> turns, shifts;
  std::vector<double> errors;
  try {
    cv::solvePnPGeneric(object, image, K, {}, turns, shifts, false, cv::SOLVEPNP_IPPE,
                        cv::noArray(), cv::noArray(), errors);
    if (turns.empty()) return std::nullopt;
    const auto best =
        static_cast<std::size_t>(std::min_element(errors.begin(), errors.end()) - errors.begin());
    cv::solvePnPRefineLM(object, image, K, {}, turns[best], shifts[best]);
    const cv::Vec3d w(turns[best]), t(shifts[best]);
    const Eigen::Vector3d turn(w[0], w[1], w[2]), shift(t[0], t[1], t[2]);
    if (!turn.allFinite() || !shift.allFinite() || shift.z() <= 0.0) return std::nullopt;
    const double angle = turn.norm();
    const Eigen::Vector3d axis =
        angle > 0.0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), shift);
  } catch (const cv::Exception&) {
    return std::nullopt;  // points on a line
  }
}

CameraModel first_camera(const BoardViews& views, const std::vector<Eigen::Vector3d>& board,
                         LensModel lens) {
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> image;
  for (const BoardView& view : views.views) {
    object.emplace_back();
    image.emplace_back();
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Eigen::Vector3f p = board[view.ids[i]].cast<float>();
      const Eigen::Vector2f pixel = view.pixels[i].cast<float>();
      object.back().emplace_back(p.x(), p.y(), 0.0F);
      image.back().emplace_back(pixel.x(), pixel.y());
    }
  }
  double focal = 0.0;
  try {
    const cv::Mat K = cv::initCameraMatrix2D(object, image, {views.width, views.height}, 1.0);
    focal = K.at<double>(0, 0);
  } catch (const cv::Exception&) {
    focal = 0.0;
  }
  const auto width = static_cast<double>(views.width);
  if (!(focal > kMinFocal * width) || !(focal < kMaxFocal * width)) focal = kUsualFocal * width;
  const std::vector<double> none(coefficient_count(lens), 0.0);
  return {.width = views.width,
          .height = views.height,
          .fx = focal,
          .fy = focal,
          .cx = 0.5 * (views.width - 1),
          .cy = 0.5 * (views.height - 1),
          .distortion = LensDistortion(lens, none)};
}

}  // namespace pcavr
