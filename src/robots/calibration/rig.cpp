// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/rig.hpp"

namespace pcavr {
namespace {

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd rotation(q.w() < 0.0 ? Eigen::Quaterniond(-q.coeffs()) : q);
  return rotation.angle() * rotation.axis();
}

}  // namespace

std::vector<RigView> rig_views(const std::vector<HandEyeView>& views, CameraMount mount) {
  std::vector<RigView> rig;
  rig.reserve(views.size());
  for (const HandEyeView& view : views) {
    const bool is_on_arm = mount == CameraMount::arm;
    rig.push_back(
        {is_on_arm ? view.T_base_flange : view.T_base_flange.inverse(), view.T_camera_board});
  }
  return rig;
}

Pose board_by_view(const RigView& view, const Rig& rig) {
  const Pose T_camera_board(view.T_camera_board.rotation(),
                            rig.board_scale * view.T_camera_board.translation());
  return view.T_world_mount * rig.T_mount_camera * T_camera_board;
}

Vector6d residual_of(const RigView& view, const Rig& rig) {
  const Pose found = board_by_view(view, rig);
  Vector6d residual;
  residual.head<3>() = found.translation() - rig.T_world_board.translation();
  residual.tail<3>() = rotation_vector(found.rotation() * rig.T_world_board.rotation().conjugate());
  return residual;
}

RigJacobian jacobian_of(const RigView& view, const Rig& rig) {
  const Eigen::Matrix3d R_world_camera =
      (view.T_world_mount * rig.T_mount_camera).rotation_matrix();
  const Eigen::Matrix3d R_world_board = rig.T_world_board.rotation_matrix();
  const Eigen::Vector3d p_camera_board = rig.board_scale * view.T_camera_board.translation();
  RigJacobian jacobian = RigJacobian::Zero(6, kRigParameters);
  jacobian.block<3, 3>(0, 0) = R_world_camera;
  jacobian.block<3, 3>(0, 3) = -R_world_camera * skew(p_camera_board);
  jacobian.block<3, 3>(3, 3) = R_world_camera;
  jacobian.block<3, 3>(0, 6) = -R_world_board;
  jacobian.block<3, 3>(3, 9) = -R_world_board;
  jacobian.block<3, 1>(0, 12) = R_world_camera * view.T_camera_board.translation();
  return jacobian;
}

Rig moved(const Rig& rig, const RigVector& step) {
  return {rig.T_mount_camera * Pose::exp(step.segment<6>(0)),
          rig.T_world_board * Pose::exp(step.segment<6>(6)), rig.board_scale + step[12]};
}

}  // namespace pcavr
