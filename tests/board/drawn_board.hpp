// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/board/board.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {

/// Grey value of a board at a place of its plane [m], white around it.
class BoardPaint {
 public:
  explicit BoardPaint(const Board& board) : board_(board) {
    const int tags = board.kind == BoardKind::charuco ? board.columns * board.rows / 2
                     : board.kind == BoardKind::tags  ? board.columns * board.rows
                                                      : 0;
    for (int id = 0; id < tags; ++id) pictures_.push_back(tag_picture(board.family, id).value());
  }

  [[nodiscard]] int at(const Eigen::Vector2d& p) const {
    const auto column = static_cast<int>(std::floor(p.x() / board_.pitch));
    const auto row = static_cast<int>(std::floor(p.y() / board_.pitch));
    const Eigen::Vector2d inside = p - board_.pitch * Eigen::Vector2d(column, row);
    const bool is_in = column >= 0 && row >= 0 && column < board_.columns && row < board_.rows;
    switch (board_.kind) {
      case BoardKind::dots: {
        const Eigen::Vector2d nearest = (p / board_.pitch).array().round();
        const bool is_dot = nearest.x() >= 0.0 && nearest.y() >= 0.0 &&
                            nearest.x() < board_.columns && nearest.y() < board_.rows;
        const double radius = board_.pitch * (nearest.norm() < 0.5 && has_large_dot ? 0.4 : 0.25);
        return is_dot && (p - board_.pitch * nearest).norm() < radius ? 30 : 220;
      }
      case BoardKind::chessboard: {
        const bool is_square =
            column >= -1 && row >= -1 && column < board_.columns && row < board_.rows;
        return is_square && (column + row) % 2 == 0 ? 30 : 220;
      }
      case BoardKind::tags:
        return is_in ? tag(row_from_top(row) * board_.columns + column, inside) : 220;
      case BoardKind::charuco: {
        if (!is_in) return 220;
        const int top = row_from_top(row);
        if ((top + column) % 2 == 0) return 30;
        const double inset = 0.5 * (board_.pitch - board_.tag_side);
        return tag((top * board_.columns + column) / 2, inside - Eigen::Vector2d(inset, inset));
      }
    }
    return 220;
  }

  bool has_large_dot = true;

 private:
  [[nodiscard]] int row_from_top(int row) const { return board_.rows - 1 - row; }
  [[nodiscard]] int tag(int id, const Eigen::Vector2d& p) const {
    const TagPicture& picture = pictures_[static_cast<std::size_t>(id)];
    const double cell = board_.tag_side / (picture.cells - 2 * picture.border);
    const auto column = static_cast<int>(std::floor(p.x() / cell)) + picture.border;
    const auto row =
        picture.cells - 1 - (static_cast<int>(std::floor(p.y() / cell)) + picture.border);
    if (column < 0 || row < 0 || column >= picture.cells || row >= picture.cells) return 220;
    return picture.is_white[static_cast<std::size_t>(row * picture.cells + column)] ? 220 : 30;
  }

  const Board& board_;
  std::vector<TagPicture> pictures_;
};

/// A picture of the board, each pixel the mean of 4 x 4 rays.
inline ColorImage draw_board(const BoardPaint& paint, const CameraModel& camera,
                             const Pose& T_camera_board) {
  constexpr int kRays = 4;
  const Pose T_board_camera = T_camera_board.inverse();
  ColorImage image(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      int sum = 0;
      for (int i = 0; i < kRays * kRays; ++i) {
        const Eigen::Vector2d pixel(x + (i % kRays + 0.5) / kRays - 0.5,
                                    y + (i / kRays + 0.5) / kRays - 0.5);
        const Eigen::Vector3d ray = T_board_camera.rotation() * camera.unproject(pixel, 1.0);
        const Eigen::Vector3d& from = T_board_camera.translation();
        sum += paint.at((from - from.z() / ray.z() * ray).head<2>());
      }
      const auto grey = static_cast<std::uint8_t>(sum / (kRays * kRays));
      image(x, y) = {grey, grey, grey};
    }
  }
  return image;
}

inline std::string picture_name(int number) { return "picture_" + std::to_string(number) + ".png"; }

inline void write_picture(const std::filesystem::path& file, const ColorImage& image) {
  (void)write_file(file, encode_color_png(image));
}

/// A camera that looks at the board's middle from `distance` [m], tilted [rad] about its axes.
inline Pose looking_at(const Board& board, double distance, double about_x, double about_y,
                       double about_sight = 0.0) {
  const Eigen::Matrix3d facing = Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(about_sight, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()) *
                                  Eigen::Quaterniond(facing);
  return Pose(turn, {0.0, 0.0, distance}) * Pose::from_translation(-board.centre());
}

}  // namespace pcavr
