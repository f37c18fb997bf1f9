// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/perception/board/board_views.hpp"

namespace pcavr {

/// A board's points in a camera, with noise [px], those that are in the image.
inline BoardView projected_view(const Board& board, const CameraModel& camera,
                                const Pose& T_camera_board, double noise, Random& random) {
  BoardView view;
  const std::vector<Eigen::Vector3d> points = board.points();
  for (std::size_t id = 0; id < points.size(); ++id) {
    const Eigen::Vector3d p = T_camera_board * points[id];
    if (p.z() <= 0.05) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (!camera.contains(pixel)) continue;
    view.ids.push_back(id);
    view.pixels.push_back(pixel + noise * Eigen::Vector2d(random.normal(), random.normal()));
  }
  return view;
}

/// Views of a board from random sides, tilted by up to `tilt` [rad].
inline BoardViews projected_views(const Board& board, const CameraModel& camera, int count,
                                  double noise, Random& random, double tilt = 0.7) {
  BoardViews views{.width = camera.width, .height = camera.height};
  const Eigen::Matrix3d facing = Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
  while (static_cast<int>(views.views.size()) < count) {
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(tilt * random.uniform(-1.0, 1.0), Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(tilt * random.uniform(-1.0, 1.0), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ()) *
        Eigen::Quaterniond(facing);
    const double distance = random.uniform(0.35, 0.6);
    const Eigen::Vector3d at(random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05), distance);
    BoardView view = projected_view(
        board, camera, Pose(turn, at) * Pose::from_translation(-board.centre()), noise, random);
    if (view.ids.size() < board.points().size() / 2) continue;
    view.number = static_cast<int>(views.views.size());
    view.name = "view " + std::to_string(view.number);
    views.views.push_back(std::move(view));
  }
  return views;
}

}  // namespace pcavr
