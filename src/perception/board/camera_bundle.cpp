// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/camera_bundle.hpp"

#include <numeric>

#include "perception/board/board_pose.hpp"

namespace pcavr {

CameraBundle CameraBundle::of_views(const BoardViews& views, const Board& board, LensModel lens) {
  const std::vector<Eigen::Vector3d> places = board.points();
  CameraBundle bundle;
  bundle.start.camera = first_camera(views, places, lens);
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const std::vector<Eigen::Vector3d> points = points_of(views.views[i], places);
    const auto T_camera_board = board_pose(bundle.start.camera, points, views.views[i].pixels);
    if (!T_camera_board) continue;
    bundle.views.push_back({points, views.views[i].pixels, T_camera_board->inverse()});
    bundle.start.T_base_flange.push_back(T_camera_board->inverse());
    bundle.given.push_back(i);
  }
  return bundle;
}

CameraBundle CameraBundle::of(const std::vector<std::size_t>& indices,
                              const CameraModel& camera) const {
  CameraBundle part;
  part.start.camera = camera;
  for (const std::size_t index : indices) {
    const BundleView& view = views[index];
    const auto T_camera_board = board_pose(camera, view.points_board, view.pixels);
    part.views.push_back(view);
    part.start.T_base_flange.push_back(T_camera_board ? T_camera_board->inverse()
                                                      : view.T_base_flange);
    part.given.push_back(given[index]);
  }
  return part;
}

std::vector<std::size_t> CameraBundle::indices() const {
  std::vector<std::size_t> all(views.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

BundleOptions camera_freedom(const CameraCalibrationOptions& options) {
  BundleOptions freed{.with_rig = false, .with_camera = true};
  const auto count = static_cast<int>(coefficient_count(options.lens));
  for (int i = 0; i < count; ++i) {
    const bool is_k3 = options.lens == LensModel::plumb_bob && i == 4;
    if (!is_k3 || options.with_k3) freed.lens.push_back(i);
  }
  return freed;
}

}  // namespace pcavr
