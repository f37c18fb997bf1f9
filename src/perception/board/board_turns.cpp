// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/board_turns.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kMaxTurnedRotation = 0.09;  ///< [rad] 5 degrees, of a board that is turned by 90

/// Difference of the angles by which flange and board turn between two views [rad].
double angle_difference(const HandEyeView& a, const HandEyeView& b) {
  return std::abs(rotation_distance(a.T_base_flange, b.T_base_flange) -
                  rotation_distance(a.T_camera_board, b.T_camera_board));
}

}  // namespace

void resolve_turns(const Board& board, const std::vector<ArmPicture>& given,
                   std::vector<HandEyeView>& views) {
  // Each view against all before it: one alone may be ambiguous, such as with a turn by 90 degrees
  // about the line of sight.
  for (std::size_t i = 1; i < views.size(); ++i) {
    const int turns = given[i].board.turns;
    if (turns <= 1) continue;
    const Pose T_camera_board = views[i].T_camera_board;
    double best = 0.0;
    Pose chosen = T_camera_board;
    for (int turn = 0; turn < turns; ++turn) {
      views[i].T_camera_board = T_camera_board * board.turned(turn * 4 / turns);
      double sum = 0.0;
      for (std::size_t j = 0; j < i; ++j) sum += angle_difference(views[i], views[j]);
      if (turn > 0 && sum >= best) continue;
      best = sum;
      chosen = views[i].T_camera_board;
    }
    views[i].T_camera_board = chosen;
  }
}

std::optional<int> turned_degrees(const Board& board, const HandEyeView& view,
                                  const HandEyeResult& found) {
  const bool is_on_arm = found.mount == CameraMount::arm;
  const Pose T_fixed_mount = is_on_arm ? view.T_base_flange : view.T_base_flange.inverse();
  const Pose T_fixed_board = T_fixed_mount * found.camera.T_a_b * view.T_camera_board;
  const double size = (board.points().back() - board.points().front()).norm();
  for (const int quarters : {1, 2, 3}) {
    const Pose turned = T_fixed_board * board.turned(quarters);
    if (rotation_distance(turned, found.board.T_a_b) > kMaxTurnedRotation) continue;
    const Eigen::Vector3d shift = turned * board.centre() - found.board.T_a_b * board.centre();
    if (shift.norm() < size) return 90 * quarters;
  }
  return std::nullopt;
}

}  // namespace pcavr
