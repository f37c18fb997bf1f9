// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/next_pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMaxTilt = 60.0 * kDegree;  ///< of a board's normal, from which it is still found
constexpr Eigen::Index kPoses = kRigParameters - 1;  ///< parameters but the board's scale
constexpr double kMaxRatio = 0.95;                   ///< of the std after and before a useful pose

struct Turn {
  const char* axis;
  Eigen::Vector3d direction_board;
};

/// [m] The largest std of the camera's position, with this information on rig's parameters but the
/// board's scale; nullopt where it is not observable.
std::optional<double> largest_std(const RigMatrix& information) {
  const Eigen::MatrixXd normal = information.topLeftCorner(kPoses, kPoses);
  const Eigen::VectorXd unit = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * normal * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  constexpr double kMinEigenvalue = 1e-12;
  if (!(solver.eigenvalues()[0] > kMinEigenvalue)) return std::nullopt;
  const Eigen::MatrixXd inverse = scaled.ldlt().solve(Eigen::MatrixXd::Identity(kPoses, kPoses));
  const Eigen::MatrixXd covariance = unit.asDiagonal() * inverse * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> position(covariance.topLeftCorner<3, 3>());
  return std::sqrt(position.eigenvalues()[2]);
}

/// The view from which to turn: the board's distance is the median.
std::size_t central_view(const std::vector<RigView>& views, const std::vector<std::size_t>& used) {
  std::vector<std::size_t> order = used;
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  std::nth_element(order.begin(), middle, order.end(), [&](std::size_t a, std::size_t b) {
    return views[a].T_camera_board.translation().norm() <
           views[b].T_camera_board.translation().norm();
  });
  return *middle;
}

/// The view after a turn of mount and camera about the board's origin.
RigView turned(const RigView& view, const Rig& rig, const Eigen::Vector3d& axis_board,
               double angle) {
  const Pose turn(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_board)),
                  Eigen::Vector3d::Zero());
  RigView after;
  after.T_world_mount = rig.T_world_board * turn * rig.T_world_board.inverse() * view.T_world_mount;
  after.T_camera_board = (after.T_world_mount * rig.T_mount_camera).inverse() * rig.T_world_board;
  return after;
}

/// Angle between the board's normal, on the camera's side, and the line of sight.
double tilt_of(const RigView& view) {
  const Eigen::Vector3d camera_board = view.T_camera_board.inverse().translation();
  return std::acos(std::clamp(std::abs(camera_board.z()) / camera_board.norm(), 0.0, 1.0));
}

}  // namespace

std::optional<NextPose> plan_next_pose(const std::vector<RigView>& views,
                                       const std::vector<HandEyeView>& named, const RigFit& fit,
                                       const RigFitOptions& options) {
  const std::size_t from = central_view(views, fit.used);
  const RigView& start = views[from];
  const double now = fit.unobservable ? 0.0 : largest_std(fit.information).value_or(0.0);
  const Eigen::Vector3d sight = start.T_camera_board.inverse().translation().normalized();
  const double diagonal = std::sqrt(0.5);
  const Turn turns[] = {{"x axis", Eigen::Vector3d::UnitX()},
                        {"y axis", Eigen::Vector3d::UnitY()},
                        {"axis between x and y", {diagonal, diagonal, 0.0}},
                        {"axis between x and -y", {diagonal, -diagonal, 0.0}},
                        {"line of sight", sight}};
  const double before = tilt_of(start);
  std::optional<NextPose> best;
  for (const Turn& turn : turns) {
    for (const double degrees : {-60.0, -40.0, 40.0, 60.0}) {
      const RigView view = turned(start, fit.rig, turn.direction_board, degrees * kDegree);
      if (tilt_of(view) > std::max(kMaxTilt, before + 1e-6)) continue;
      const LinearView linear{noise_shape(view, fit.rig, options.mount), Vector6d::Zero(),
                              jacobian_of(view, fit.rig)};
      const Matrix6d weight = covariance_of(linear.shape, fit.variances).inverse();
      const std::optional<double> expected =
          largest_std(fit.information + linear.jacobian.transpose() * weight * linear.jacobian);
      if (!expected || (best && *expected >= best->std_expected)) continue;
      const bool is_on_arm = options.mount == CameraMount::arm;
      best = NextPose{
          .T_base_flange = is_on_arm ? view.T_world_mount : view.T_world_mount.inverse(),
          .text = fmt::format("from {}, turn the {} by {:.0f} degrees about the board's {}",
                              named[from].name, is_on_arm ? "camera" : "board",
                              is_on_arm ? degrees : -degrees, turn.axis),
          .std_expected = *expected};
    }
  }
  if (!best) return std::nullopt;
  if (!fit.unobservable) {
    if (best->std_expected > kMaxRatio * now) return std::nullopt;
    best->std_now = now;
  }
  return best;
}

}  // namespace pcavr
