// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/hand_eye.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "robots/calibration/calibrated_pose.hpp"
#include "robots/calibration/input_checks.hpp"
#include "robots/calibration/next_pose.hpp"
#include "robots/calibration/rig_fit.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinViews = 3;
constexpr double kMinRotation = 0.0087;  ///< [rad] half a degree rms: less shows no camera
/// A coordinate does not show where the direction that does not has this part in it.
constexpr double kMaxShare = 0.1;
constexpr double kScaleStds = 3.0;  ///< of a board's scale that differs from 1
constexpr double kMaxScaleStd = 0.05;
/// -2 log likelihood by which one cause explains the residuals better than the other: 2 std.
constexpr double kMinDeviance = 4.0;
constexpr std::size_t kMinHeldOut = 9;  ///< views: a third of fewer is no judgement

std::vector<std::size_t> all_indices(std::size_t count) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

Error too_few(std::size_t count) {
  return {.message = fmt::format("{} views are too few: {} with different rotations are needed, "
                                 "and ten or more for a judgement",
                                 count, kMinViews),
          .place = "CAMERA"};
}

/// Fits without the board's scale, and with it where it differs from 1.
struct ChosenFit {
  RigFit fit = {};
  RigFitOptions options = {};
  double scale = 1.0, scale_std = 0.0;
  std::vector<RigView> views = {};  ///< with the board's frame at its best point
  Eigen::Vector3d best_point = Eigen::Vector3d::Zero();
};

constexpr int kPointRounds = 3;  ///< of fit and best point, which settles

ChosenFit choose_fit(const std::vector<RigView>& given, const Rig& start, CameraMount mount) {
  ChosenFit chosen{.options = {.mount = mount}, .views = given};
  std::vector<RigView>& views = chosen.views;
  const std::vector<std::size_t> all = all_indices(views.size());
  chosen.fit = fit_rig(views, all, start, chosen.options);
  for (int round = 0; round < kPointRounds; ++round) {
    const Eigen::Vector3d shift = best_point(views, chosen.fit);
    move_board(shift, views);
    chosen.best_point += shift;
    Rig rig = chosen.fit.rig;
    rig.T_world_board = rig.T_world_board * Pose::from_translation(shift);
    chosen.fit = fit_rig(views, all, rig, chosen.options);
  }
  const RigFitOptions with_scale{.mount = mount, .with_scale = true};
  RigFit scaled = refit_rig(views, chosen.fit.used, chosen.fit, with_scale);
  chosen.scale = scaled.rig.board_scale;
  chosen.scale_std = std::sqrt(std::max(scaled.covariance(12, 12), 0.0));
  const bool differs = std::abs(chosen.scale - 1.0) > kScaleStds * chosen.scale_std;
  if (differs && chosen.scale_std < kMaxScaleStd && chosen.fit.used.size() > kMinViews) {
    chosen.options = with_scale;
    chosen.fit = fit_rig(views, all, scaled.rig, with_scale);
  }
  return chosen;
}

/// rms of the board's position in each used view, by a fit of the others: the residual without the
/// view's own influence, which is exact for linear equations.
double leave_one_out_rms(const std::vector<LinearView>& linear, const RigFit& fit) {
  double sum = 0.0;
  for (const LinearView& view : linear) {
    const Matrix6d weight = covariance_of(view.shape, fit.variances).inverse();
    const Matrix6d influence = view.jacobian * fit.covariance * view.jacobian.transpose() * weight;
    const Vector6d alone = (Matrix6d::Identity() - influence).fullPivLu().solve(view.residual);
    sum += alone.head<3>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(linear.size()));
}

std::optional<double> held_out_rms(const std::vector<RigView>& views, const ChosenFit& chosen,
                                   const HandEyeOptions& options) {
  double sum = 0.0, judged = 0.0;
  for (const ViewSplit& split : view_splits(chosen.fit.used, options)) {
    const RigFit fit = refit_rig(views, split.fitted, chosen.fit, chosen.options);
    for (const std::size_t index : split.judged) {
      sum += residual_of(views[index], fit.rig).head<3>().squaredNorm();
      judged += 1.0;
    }
  }
  return judged > 0.0 ? std::optional(std::sqrt(sum / judged)) : std::nullopt;
}

/// The view whose board fits this arm pose, but its own.
std::optional<std::string> partner_of(std::size_t view, const std::vector<RigView>& views,
                                      const std::vector<HandEyeView>& named,
                                      const ChosenFit& chosen) {
  std::optional<std::string> partner;
  double best = outlier_limit(chosen.fit.used.size());
  for (std::size_t other = 0; other < views.size(); ++other) {
    if (other == view) continue;
    const std::vector<RigView> pair{{views[view].T_world_mount, views[other].T_camera_board}};
    const double distance = squared_distance(
        linearised(pair, {0}, chosen.fit.rig, chosen.options.mount).front(), chosen.fit, false);
    if (distance >= best) continue;
    best = distance;
    partner = named[other].name;
  }
  return partner;
}

std::vector<HandEyeResidual> residuals_of(const std::vector<RigView>& views,
                                          const std::vector<HandEyeView>& named,
                                          const ChosenFit& chosen) {
  std::vector<HandEyeResidual> residuals;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Vector6d residual = residual_of(views[i], chosen.fit.rig);
    HandEyeResidual of_view{.view = named[i].name,
                            .position = residual.head<3>(),
                            .rotation = residual.tail<3>(),
                            .distance = views[i].T_camera_board.translation().norm()};
    of_view.is_outlier = !std::binary_search(chosen.fit.used.begin(), chosen.fit.used.end(), i);
    if (of_view.is_outlier) of_view.partner = partner_of(i, views, named, chosen);
    residuals.push_back(std::move(of_view));
  }
  return residuals;
}

/// Mean square of the board's position by each source, of unit variance [m^2].
Eigen::Matrix<double, kSources, 1> position_shares(const std::vector<LinearView>& linear) {
  Eigen::Matrix<double, kSources, 1> shares = Eigen::Matrix<double, kSources, 1>::Zero();
  for (const LinearView& view : linear) {
    for (std::size_t source = 0; source < kSources; ++source) {
      shares[static_cast<Eigen::Index>(source)] +=
          covariance_of_source(view.shape, source).topLeftCorner<3, 3>().trace() /
          static_cast<double>(linear.size());
    }
  }
  return shares;
}

HandEyeCause cause_of(const std::vector<RigView>& views, const std::vector<LinearView>& linear,
                      const ChosenFit& chosen) {
  const RigFit& fit = chosen.fit;
  const Eigen::Matrix<double, kSources, 1> shares = position_shares(linear);
  const Eigen::Matrix<double, kSources, kSources> covariance =
      covariance_of_variances(linear, fit.covariance, fit.variances);
  const auto part = [&](Eigen::Index first, double& rms, double& std) {
    const Eigen::Vector2d share = shares.segment<2>(first);
    const auto source = static_cast<std::size_t>(first);
    const double square = share[0] * fit.variances[source] + share[1] * fit.variances[source + 1];
    const double variance = share.dot(covariance.block<2, 2>(first, first) * share);
    rms = std::sqrt(square);
    // Of a cause that explains nothing, the std is of its square alone.
    const double square_std = std::sqrt(std::max(variance, 0.0));
    std = rms > std::sqrt(square_std) ? square_std / (2.0 * rms) : std::sqrt(square_std);
  };
  HandEyeCause cause;
  part(0, cause.arm, cause.arm_std);
  part(2, cause.camera, cause.camera_std);
  const double by_all = deviance_with(views, fit, chosen.options, {true, true, true, true, true});
  const double by_arm = deviance_with(views, fit, chosen.options, {true, true, false, false, true});
  const double by_camera =
      deviance_with(views, fit, chosen.options, {false, false, true, true, true});
  cause.is_separable = std::abs(by_arm - by_camera) > kMinDeviance ||
                       std::min(by_arm, by_camera) - by_all > kMinDeviance;
  return cause;
}

void add_notes(const ChosenFit& chosen, HandEyeResult& result) {
  if (result.unobservable) {
    const Eigen::Vector3d& axis = *result.unobservable;
    result.notes.push_back(fmt::format(
        "all rotations are about one axis: the camera's position along ({:.2f}, {:.2f}, {:.2f}) of "
        "the {} is not observable",
        axis.x(), axis.y(), axis.z(), result.mount == CameraMount::arm ? "flange" : "base"));
  }
  for (const HandEyeResidual& residual : result.residuals) {
    if (!residual.is_outlier) continue;
    result.notes.push_back(fmt::format(
        "{} does not fit, and is left out: {:.1f} mm, {:.2f} degrees off{}", residual.view,
        1e3 * residual.position.norm(), residual.rotation.norm() * 180.0 / std::numbers::pi,
        residual.partner ? "; its arm pose fits the board pose of " + *residual.partner : ""));
  }
  if (result.is_board_scale_used) {
    result.notes.push_back(board_scale_note(result));
  }
  if (chosen.fit.used.size() < kMinHeldOut) {
    result.notes.push_back(fmt::format("{} views are few: errors on unseen poses are not judged",
                                       chosen.fit.used.size()));
  }
}

HandEyeResult result_of(const std::vector<HandEyeView>& named, const ChosenFit& chosen,
                        const HandEyeOptions& options) {
  const RigFit& fit = chosen.fit;
  const std::vector<RigView>& views = chosen.views;
  HandEyeResult result{.mount = options.mount, .unobservable = fit.unobservable};
  std::optional<Eigen::Vector3d> unobservable_world;
  if (fit.unobservable) {
    unobservable_world = views[fit.used.front()].T_world_mount.rotation() * *fit.unobservable;
  }
  result.camera =
      calibrated(fit.rig.T_mount_camera, fit.covariance.topLeftCorner<6, 6>(), fit.unobservable);
  result.board = board_at_origin(fit.rig, fit.covariance.block<6, 6>(6, 6), chosen.best_point,
                                 unobservable_world);
  result.best_point_board = chosen.best_point;
  result.board_scale = chosen.scale;
  result.board_scale_std = chosen.scale_std;
  result.is_board_scale_used = chosen.options.with_scale;
  const Variances& v = fit.variances;
  result.noise = {std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3]),
                  std::sqrt(v[4])};
  const std::vector<LinearView> linear = linearised(views, fit.used, fit.rig, options.mount);
  result.cause = cause_of(views, linear, chosen);
  result.residuals = residuals_of(views, named, chosen);
  for (const LinearView& view : linear) {
    result.position_rms +=
        view.residual.head<3>().squaredNorm() / static_cast<double>(linear.size());
    result.rotation_rms +=
        view.residual.tail<3>().squaredNorm() / static_cast<double>(linear.size());
  }
  result.position_rms = std::sqrt(result.position_rms);
  result.rotation_rms = std::sqrt(result.rotation_rms);
  result.leave_one_out_rms = leave_one_out_rms(linear, fit);
  result.held_out_rms = held_out_rms(views, chosen, options);
  result.next = plan_next_pose(views, named, fit, chosen.options);
  add_notes(chosen, result);
  return result;
}

}  // namespace

CalibratedPose calibrated(const Pose& T_a_b, const Matrix6d& covariance,
                          const std::optional<Eigen::Vector3d>& unobservable) {
  CalibratedPose pose{.T_a_b = T_a_b, .covariance = covariance};
  const Eigen::Matrix3d R = T_a_b.rotation_matrix();
  const Eigen::Matrix3d position = R * covariance.topLeftCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d rotation = R * covariance.bottomRightCorner<3, 3>() * R.transpose();
  for (int axis = 0; axis < 3; ++axis) {
    pose.rotation_std[axis] = std::sqrt(std::max(rotation(axis, axis), 0.0));
    if (unobservable && std::abs((*unobservable)[axis]) > kMaxShare) continue;
    pose.position_std[axis] = std::sqrt(std::max(position(axis, axis), 0.0));
  }
  return pose;
}

CalibratedPose board_at_origin(const Rig& at_point, const Matrix6d& covariance,
                               const Eigen::Vector3d& best_point,
                               const std::optional<Eigen::Vector3d>& unobservable_world) {
  Matrix6d adjoint = Matrix6d::Identity();
  adjoint.topRightCorner<3, 3>() = skew(best_point);
  const Pose T_world_board =
      at_point.T_world_board * Pose::from_translation(-at_point.board_scale * best_point);
  return calibrated(T_world_board, adjoint * covariance * adjoint.transpose(), unobservable_world);
}

std::vector<ViewSplit> view_splits(const std::vector<std::size_t>& views,
                                   const HandEyeOptions& options) {
  const std::size_t count = views.size();
  std::vector<ViewSplit> splits;
  if (count < kMinHeldOut) return splits;
  const Random seed(options.seed);
  for (int split = 0; split < options.splits; ++split) {
    Random random = seed.fork(static_cast<std::uint64_t>(split));
    std::vector<std::size_t> order = views;
    for (std::size_t i = count - 1; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(2 * count / 3);
    ViewSplit& one = splits.emplace_back();
    one.fitted.assign(order.begin(), middle);
    one.judged.assign(middle, order.end());
    std::sort(one.fitted.begin(), one.fitted.end());
  }
  return splits;
}

std::string board_scale_note(const HandEyeResult& result) {
  return fmt::format(
      "by the arm's motion the board is {:.4f} +- {:.4f} of the size that the poses were computed "
      "with: used so",
      result.board_scale, result.board_scale_std);
}

Expected<HandEyeResult> calibrate_hand_eye(const std::vector<HandEyeView>& views,
                                           const HandEyeOptions& options) {
  if (views.size() < kMinViews) return too_few(views.size());
  const std::vector<RigView> rig = rig_views(views, options.mount);
  const std::vector<std::size_t> all = all_indices(rig.size());
  const RotationSpread spread = rotation_spread(rig, all);
  if (spread.first < kMinRotation) {
    return Error{.message = fmt::format("all poses are parallel (rotations spread by {:.2f} "
                                        "degrees): they do not show where the camera is",
                                        spread.first * 180.0 / std::numbers::pi),
                 .place = "ROBOT",
                 .hint = "add views with the flange turned by 30 degrees or more about two axes"};
  }
  if (auto error = find_input_error(rig, options.mount)) return *std::move(error);
  const std::optional<Rig> start = find_start(rig, all);
  if (!start) {
    return Error{.message = "the board does not turn in the camera's frame",
                 .place = "CAMERA",
                 .hint = "check that its poses are those of the same views"};
  }
  return result_of(views, choose_fit(rig, *start, options.mount), options);
}

double board_rms(const HandEyeResult& result, const std::vector<HandEyeView>& views,
                 const Eigen::Vector3d& point_board) {
  PCAVR_REQUIRE(!views.empty());
  const Rig rig{result.camera.T_a_b, result.board.T_a_b,
                result.is_board_scale_used ? result.board_scale : 1.0};
  double sum = 0.0;
  const Eigen::Vector3d point = rig.board_scale * point_board;
  for (const RigView& view : rig_views(views, result.mount)) {
    sum += (board_by_view(view, rig) * point - rig.T_world_board * point).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(views.size()));
}

std::string describe_cause(const HandEyeResult& result) {
  const HandEyeCause& cause = result.cause;
  if (!cause.is_separable) {
    return fmt::format(
        "the views scatter by {:.2g} mm; whether by the camera or by the arm can't be "
        "separated: vary the board's distance",
        1e3 * result.position_rms);
  }
  constexpr double kMuchMore = 2.0;
  std::string text =
      fmt::format("the camera explains {:.2g} +- {:.2g} mm, the arm {:.2g} +- {:.2g} mm",
                  1e3 * cause.camera, 1e3 * cause.camera_std, 1e3 * cause.arm, 1e3 * cause.arm_std);
  if (cause.arm > kMuchMore * cause.camera) return text + ": better pictures won't help";
  if (cause.camera > kMuchMore * cause.arm) {
    return text + ": sharper pictures, a nearer or larger board will help, a better arm won't";
  }
  return text + ": both matter";
}

}  // namespace pcavr
