// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/refine_rig.hpp"

#include <array>

#include <ceres/ceres.h>

namespace pcavr {
namespace {

constexpr int kMaxSolverSteps = 50;
constexpr double kLossScale = 2.0;  ///< [units] residuals below it count by their squares

using PoseBlock = std::array<double, 7>;  ///< quaternion x y z w, position

PoseBlock block_of(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  const Eigen::Vector3d& p = pose.translation();
  return {q.x(), q.y(), q.z(), q.w(), p.x(), p.y(), p.z()};
}

Pose pose_of(const PoseBlock& block) {
  return Pose(Eigen::Quaterniond(Eigen::Map<const Eigen::Quaterniond>(block.data())),
              Eigen::Vector3d::Map(block.data() + 4));
}

/// residual_of(), for small rotations, in units.
struct BoardError {
  RigView view;
  double board_scale;
  double position_unit;  ///< [m]
  double rotation_unit;  ///< [rad]

  template <typename T>
  bool operator()(const T* camera, const T* board, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> q_camera(camera), q_board(board);
    const Eigen::Map<const Vector> p_camera(camera + 4), p_board(board + 4);
    const Eigen::Quaternion<T> q_view = view.T_world_mount.rotation().cast<T>();
    const Vector p_seen = (board_scale * view.T_camera_board.translation()).cast<T>();
    const Vector p_mount = q_camera * p_seen + p_camera;
    const Eigen::Quaternion<T> q_found =
        q_view * q_camera * view.T_camera_board.rotation().cast<T>();
    const Eigen::Quaternion<T> turn = q_found * q_board.conjugate();
    Eigen::Map<Vector>{residual} =
        (q_view * p_mount + view.T_world_mount.translation().cast<T>() - p_board) /
        T(position_unit);
    Eigen::Map<Vector>{residual + 3} =
        turn.vec() * T(2.0 / rotation_unit) * (turn.w() < T(0.0) ? T(-1.0) : T(1.0));
    return true;
  }
};

}  // namespace

Rig refine_robustly(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
                    const Rig& start, double position_unit, double rotation_unit) {
  ceres::CauchyLoss loss(kLossScale);
  PoseBlock camera = block_of(start.T_mount_camera), board = block_of(start.T_world_board);
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> manifold;
  ceres::Problem::Options problem_options;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddParameterBlock(camera.data(), 7, &manifold);
  problem.AddParameterBlock(board.data(), 7, &manifold);
  for (const std::size_t index : indices) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<BoardError, 6, 7, 7>(new BoardError{
                                 views[index], start.board_scale, position_unit, rotation_unit}),
                             &loss, camera.data(), board.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = kMaxSolverSteps;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {pose_of(camera), pose_of(board), start.board_scale};
}

}  // namespace pcavr
