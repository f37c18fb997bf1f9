// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/next_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMaxTilt = 60.0 * kDegree;  ///< of a board's normal, from which it is still found
constexpr Eigen::Index kPoses = kRigParameters - 1;  ///< parameters but the board's scale
constexpr double kMaxRatio = 0.95;                   ///< of the std after and before a useful pose
constexpr std::size_t kMaxStarts = 12;               ///< views from which a turn is considered
/// [m] beyond the box that the flange was in: arms reach a hand's breadth farther.
constexpr double kMargin = 0.1;
/// From the nearest rotation that was seen: wrists seldom turn farther at once.
constexpr double kMaxRotation = 45.0 * kDegree;

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

/// Up to kMaxStarts of the used views, evenly spread in their order.
std::vector<std::size_t> starts_of(const std::vector<std::size_t>& used) {
  const std::size_t count = std::min(used.size(), kMaxStarts);
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < count; ++i) starts.push_back(used[i * used.size() / count]);
  return starts;
}

Pose flange_of(const RigView& view, CameraMount mount) {
  return mount == CameraMount::arm ? view.T_world_mount : view.T_world_mount.inverse();
}

/// Where the flange was, in base: what the arm is known to reach.
class SeenReach {
 public:
  SeenReach(const std::vector<HandEyeView>& views, const std::vector<std::size_t>& used) {
    for (const std::size_t index : used) {
      const Pose& T_base_flange = views[index].T_base_flange;
      box_.extend(T_base_flange.translation());
      max_distance_ = std::max(max_distance_, T_base_flange.translation().norm());
      rotations_.push_back(T_base_flange.rotation());
    }
    box_.min().array() -= kMargin;
    box_.max().array() += kMargin;
  }

  [[nodiscard]] bool contains(const Pose& T_base_flange) const {
    const Eigen::Vector3d& p = T_base_flange.translation();
    if (!box_.contains(p) || p.norm() > max_distance_) return false;
    return std::any_of(rotations_.begin(), rotations_.end(), [&](const Eigen::Quaterniond& q) {
      return q.angularDistance(T_base_flange.rotation()) < kMaxRotation;
    });
  }

 private:
  Eigen::AlignedBox3d box_;
  double max_distance_ = 0.0;
  std::vector<Eigen::Quaterniond> rotations_;
};

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

std::array<Turn, 5> turns_of(const RigView& view) {
  const Eigen::Vector3d sight = view.T_camera_board.inverse().translation().normalized();
  const double diagonal = std::sqrt(0.5);
  return {{{"x axis", Eigen::Vector3d::UnitX()},
           {"y axis", Eigen::Vector3d::UnitY()},
           {"axis between x and y", {diagonal, diagonal, 0.0}},
           {"axis between x and -y", {diagonal, -diagonal, 0.0}},
           {"line of sight", sight}}};
}

/// largest_std() after one more view.
std::optional<double> std_with(const RigView& view, const RigFit& fit, CameraMount mount) {
  const RigJacobian jacobian = jacobian_of(view, fit.rig);
  const Matrix6d weight = covariance_of(noise_shape(view, fit.rig, mount), fit.variances).inverse();
  return largest_std(fit.information + jacobian.transpose() * weight * jacobian);
}

}  // namespace

std::optional<NextPose> plan_next_pose(const std::vector<RigView>& views,
                                       const std::vector<HandEyeView>& named, const RigFit& fit,
                                       const RigFitOptions& options) {
  const double now = fit.unobservable ? 0.0 : largest_std(fit.information).value_or(0.0);
  const SeenReach reach(named, fit.used);
  std::optional<NextPose> best;
  for (const std::size_t from : starts_of(fit.used)) {
    const double max_tilt = std::max(kMaxTilt, tilt_of(views[from]) + 1e-6);
    for (const Turn& turn : turns_of(views[from])) {
      for (const double degrees : {-60.0, -40.0, -20.0, 20.0, 40.0, 60.0}) {
        const RigView view = turned(views[from], fit.rig, turn.direction_board, degrees * kDegree);
        const Pose T_base_flange = flange_of(view, options.mount);
        if (tilt_of(view) > max_tilt || !reach.contains(T_base_flange)) continue;
        const std::optional<double> expected = std_with(view, fit, options.mount);
        if (!expected || (best && *expected >= best->std_expected)) continue;
        const bool is_on_arm = options.mount == CameraMount::arm;
        best = NextPose{.T_base_flange = T_base_flange,
                        .text = fmt::format("from {}, turn the {} by {:.0f} degrees about the "
                                            "board's {}",
                                            named[from].name, is_on_arm ? "camera" : "board",
                                            is_on_arm ? degrees : -degrees, turn.axis),
                        .std_expected = *expected};
      }
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
