// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/perception/board/picture_file.hpp"
#include "pcavr/pipeline/calibrate_pictures.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// Points of a view that are compared: some thousands have a median to a tenth of a millimetre.
constexpr double kPointsOfView = 4000.0;
/// [px] in which the nearest point of the other view is searched, at steps that keep it quick.
constexpr int kSearchRadius = 16, kSearchStep = 2;
/// [m] Beyond it the other view does not show the same surface.
constexpr double kSameSurface = 0.05;
/// Depth beyond this many distances of the board is not of the arm's place of work.
constexpr double kBoardDistances = 1.5;
/// Fewer points do not overlap.
constexpr std::size_t kMinCommon = 50;

struct DepthOfView {
  DepthImage depth;
  CameraModel camera;  ///< of the depth image's size
  Pose T_base_camera;
  double farthest = 0.0;  ///< [m]

  [[nodiscard]] double at(int x, int y) const {
    const auto z = static_cast<double>(depth(x, y));
    return z > 0.0 && z <= farthest ? z : 0.0;
  }
};

/// [m] From a point in base to the nearest one of the view; infinite where none is near.
double distance_to(const Eigen::Vector3d& p_base, const DepthOfView& view) {
  const Eigen::Vector3d p = view.T_base_camera.inverse() * p_base;
  double least = HUGE_VAL;
  if (p.z() <= 0.0) return least;
  const Eigen::Vector2d pixel = view.camera.project(p);
  if (!view.camera.contains(pixel)) return least;
  const auto x0 = static_cast<int>(std::lround(pixel.x()));
  const auto y0 = static_cast<int>(std::lround(pixel.y()));
  for (int dy = -kSearchRadius; dy <= kSearchRadius; dy += kSearchStep) {
    for (int dx = -kSearchRadius; dx <= kSearchRadius; dx += kSearchStep) {
      if (!view.depth.contains(x0 + dx, y0 + dy)) continue;
      const double z = view.at(x0 + dx, y0 + dy);
      if (!(std::abs(z - p.z()) < least)) continue;
      least =
          std::min(least, (view.camera.unproject(Eigen::Vector2d(x0 + dx, y0 + dy), z) - p).norm());
    }
  }
  return least;
}

/// [m] Of the points of one view that the other shows, too.
std::vector<double> distances_between(const DepthOfView& from, const DepthOfView& to) {
  const double pixels = static_cast<double>(from.depth.width()) * from.depth.height();
  const int stride = std::max(1, static_cast<int>(std::sqrt(pixels / kPointsOfView)));
  std::vector<double> distances;
  for (int y = stride / 2; y < from.depth.height(); y += stride) {
    for (int x = stride / 2; x < from.depth.width(); x += stride) {
      const double z = from.at(x, y);
      if (!(z > 0.0)) continue;
      const Eigen::Vector3d p =
          from.T_base_camera * from.camera.unproject(Eigen::Vector2d(x, y), z);
      const double distance = distance_to(p, to);
      if (distance < kSameSurface) distances.push_back(distance);
    }
  }
  return distances;
}

/// [m] The board's distance in the view that is farthest from it.
double farthest_board(const PictureRig& rig, const Board& board) {
  double farthest = 0.0;
  for (const PictureResidual& view : rig.views) {
    const Pose T_world_board = rig.hand_eye.board.T_a_b;
    const Pose T_base_board =
        rig.hand_eye.mount == CameraMount::arm ? T_world_board : view.T_base_flange * T_world_board;
    const Eigen::Vector3d p = view.T_base_camera.inverse() * (T_base_board * board.centre());
    farthest = std::max(farthest, p.norm());
  }
  return farthest;
}

Expected<std::vector<DepthOfView>> read_depth(const PictureRig& rig, const Board& board,
                                              const std::string& images, double units_per_metre) {
  const Expected<std::vector<NumberedPicture>> files = list_pictures(images);
  if (!files) return files.error();
  const double farthest = kBoardDistances * farthest_board(rig, board);
  ImageDecoder decoder;
  std::vector<DepthOfView> views;
  for (const PictureResidual& view : rig.views) {
    const auto file = std::find_if(files->begin(), files->end(), [&](const NumberedPicture& one) {
      return fmt::format("view {}", one.number) == view.view;
    });
    if (file == files->end()) continue;
    const Expected<std::string> bytes = read_file(file->file);
    if (!bytes) return bytes.error();
    Expected<DepthImage> depth = decoder.depth(
        *bytes, {file->file.string(), rig.camera.width, rig.camera.height}, units_per_metre);
    if (!depth) return depth.error();
    const CameraModel camera = on_grid(rig.camera, depth->width(), depth->height());
    views.push_back({*std::move(depth), camera, view.T_base_camera, farthest});
  }
  if (views.size() >= 2) return views;
  return Error{.message = "has depth images of fewer than two of the views",
               .file = images,
               .hint = "give them the numbers of the pictures: depth_01.png for color_01.png"};
}

}  // namespace

Expected<DepthAgreement> compare_depth(const PictureRig& rig, const Board& board,
                                       const std::string& depth_images, double units_per_metre) {
  const auto views = read_depth(rig, board, depth_images, units_per_metre);
  if (!views) return views.error();
  DepthAgreement found{.views = views->size()};
  std::vector<double> all;
  for (std::size_t i = 0; i < views->size(); ++i) {
    for (std::size_t j = 0; j < views->size(); ++j) {
      if (i == j) continue;
      const std::vector<double> distances = distances_between((*views)[i], (*views)[j]);
      if (distances.size() < kMinCommon) continue;
      const double middle = median(distances);
      found.least = found.pairs == 0 ? middle : std::min(found.least, middle);
      found.largest = std::max(found.largest, middle);
      ++found.pairs;
      all.insert(all.end(), distances.begin(), distances.end());
    }
  }
  if (found.pairs == 0) {
    return Error{.message = "shows no surface in two views, within 5 cm",
                 .file = depth_images,
                 .hint = "check --depth-scale, and that depth is aligned to the pictures"};
  }
  found.median = median(std::move(all));
  return found;
}

}  // namespace pcavr
