// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// A view with the camera's carrier as "mount" and the frame of the board as "world": flange and
/// base, or with the camera beside the arm base and flange. Then one equation holds for both:
///     T_world_mount T_mount_camera T_camera_board = T_world_board.
struct RigView {
  Pose T_world_mount;
  Pose T_camera_board;
};
[[nodiscard]] std::vector<RigView> rig_views(const std::vector<HandEyeView>& views,
                                             CameraMount mount);

/// What all views share.
struct Rig {
  Pose T_mount_camera = {};
  Pose T_world_board = {};
  double board_scale = 1.0;  ///< true lengths over those of T_camera_board
};

/// Twists of T_mount_camera and T_world_board (right-multiplied), then board_scale.
inline constexpr int kRigParameters = 13;
using RigMatrix = Eigen::MatrixXd;  ///< square
using RigVector = Eigen::VectorXd;
using RigJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Where the view puts the board.
[[nodiscard]] Pose board_by_view(const RigView& view, const Rig& rig);

/// Position [m] and rotation vector [rad] from the rig's board to the view's, in world's axes.
[[nodiscard]] Vector6d residual_of(const RigView& view, const Rig& rig);
/// Its derivative by the rig's parameters, for small rotation residuals.
[[nodiscard]] RigJacobian jacobian_of(const RigView& view, const Rig& rig);
/// The rig moved by a step of its parameters.
[[nodiscard]] Rig moved(const Rig& rig, const RigVector& step);

}  // namespace pcavr
