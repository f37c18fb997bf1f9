// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/picture_rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "perception/board/board_pose.hpp"
#include "perception/board/board_turns.hpp"
#include "perception/board/bundle.hpp"
#include "perception/board/camera_bundle.hpp"

namespace pcavr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::size_t kMinLeftOut = 5;  ///< views: of fewer the others are no calibration
/// [m] Industrial arms are this exact or better [ISO 9283 data sheets: accuracy to 1 mm, or a few
/// without calibration]: more is another cause than the arm.
constexpr double kMaxArmError = 3e-3;
/// Of an arm whose poses are taken as they are: less than any board's points would move.
constexpr double kExactPosition = 1e-6;  // [m] a coordinate
constexpr double kExactRotation = 1e-6;  // [rad] an axis
/// Of the error of views by the others: less is the better explanation, not a draw of the noise.
constexpr double kClearlyBetter = 0.8;

/// The views with poses of the board, and how the bundle sees them.
struct PosedViews {
  std::vector<ArmPicture> given = {};
  std::vector<HandEyeView> views = {};
};

PosedViews pose_views(const std::vector<ArmPicture>& given, const Board& board,
                      const CameraModel& camera) {
  const std::vector<Eigen::Vector3d> places = board.points();
  PosedViews posed;
  for (const ArmPicture& view : given) {
    const auto T_camera_board =
        board_pose(camera, points_of(view.board, places), view.board.pixels);
    if (!T_camera_board) continue;
    posed.given.push_back(view);
    posed.views.push_back({view.board.name, view.T_base_flange, *T_camera_board});
  }
  resolve_turns(board, posed.given, posed.views);
  return posed;
}

/// The board's points of a view, with the board turned as its pose is.
BundleView bundle_view(const ArmPicture& view, const HandEyeView& posed, const Board& board,
                       const CameraModel& camera) {
  BundleView result{.points_board = points_of(view.board, board.points()),
                    .pixels = view.board.pixels,
                    .T_base_flange = view.T_base_flange};
  if (view.board.turns <= 1) return result;
  const auto plain = board_pose(camera, result.points_board, result.pixels);
  const Pose T_turned_plain = posed.T_camera_board.inverse() * *plain;
  for (Eigen::Vector3d& point : result.points_board) point = T_turned_plain * point;
  return result;
}

/// All that a fit of pictures begins with.
struct RigBundle {
  std::vector<BundleView> views = {};
  BundleModel start = {};
  BundleNoise noise = {};
  BundleOptions options = {};
};

RigBundle without_view(const RigBundle& bundle, const BundleFit& fit, std::size_t left_out) {
  RigBundle part{.start = fit.model, .noise = fit.noise, .options = bundle.options};
  part.start.T_base_flange.clear();
  part.options.with_noise = false;
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    if (i == left_out) continue;
    part.views.push_back(bundle.views[i]);
    part.start.T_base_flange.push_back(fit.model.T_base_flange[i]);
  }
  return part;
}

DistanceSpread spread_of(const std::vector<double>& distances) {
  DistanceSpread spread;
  for (const double d : distances) {
    spread.mean += d / static_cast<double>(distances.size());
    spread.max = std::max(spread.max, d);
  }
  for (const double d : distances) {
    spread.std += (d - spread.mean) * (d - spread.mean) / static_cast<double>(distances.size());
  }
  spread.std = std::sqrt(spread.std);
  return spread;
}

DistanceSpread left_out_spread(const RigBundle& bundle, const BundleFit& fit) {
  std::vector<double> distances;
  if (bundle.views.size() < kMinLeftOut) return {};
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    const RigBundle part = without_view(bundle, fit, i);
    const BundleFit others = fit_bundle(part.views, part.start, part.noise, part.options);
    const auto errors = board_errors(others.model, bundle.views[i], bundle.views[i].T_base_flange);
    distances.insert(distances.end(), errors.begin(), errors.end());
  }
  return spread_of(distances);
}

CalibratedPose calibrated_by(const Pose& T_a_b, const Matrix6d& covariance,
                             const CalibratedPose& before) {
  CalibratedPose pose{.T_a_b = T_a_b, .covariance = covariance};
  const Eigen::Matrix3d R = T_a_b.rotation_matrix();
  const Eigen::Matrix3d position = R * covariance.topLeftCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d rotation = R * covariance.bottomRightCorner<3, 3>() * R.transpose();
  for (int axis = 0; axis < 3; ++axis) {
    pose.rotation_std[axis] = std::sqrt(std::max(rotation(axis, axis), 0.0));
    if (!before.position_std[axis]) continue;
    pose.position_std[axis] = std::sqrt(std::max(position(axis, axis), 0.0));
  }
  return pose;
}

/// rms [m] of the board's middle by the pictures' noise and by the arm's.
HandEyeCause cause_by_pixels(const BundleFit& fit, const std::vector<BundleView>& views,
                             const Board& board) {
  double by_camera = 0.0, by_arm = 0.0;
  const BundleModel& model = fit.model;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Pose& flange = model.T_base_flange[i];
    const bool is_on_arm = model.mount == CameraMount::arm;
    const Eigen::Vector3d fixed = model.T_fixed_board * (model.board_scale * board.centre());
    const Eigen::Vector3d lever = is_on_arm ? flange.inverse() * fixed : fixed;
    Eigen::Matrix<double, 3, 6> moves;
    moves << Eigen::Matrix3d::Identity(), -skew(lever);
    Vector6d arm;
    arm << Eigen::Vector3d::Constant(fit.noise.arm_position * fit.noise.arm_position),
        Eigen::Vector3d::Constant(fit.noise.arm_rotation * fit.noise.arm_rotation);
    by_camera += (moves * fit.camera_board_covariance[i] * moves.transpose()).trace();
    by_arm += (moves * arm.asDiagonal() * moves.transpose()).trace();
  }
  const auto count = static_cast<double>(views.size());
  HandEyeCause cause{.camera = std::sqrt(by_camera / count),
                     .arm = std::sqrt(by_arm / count),
                     .is_separable = true};
  // Errors of one picture have causes in common: a picture counts as one.
  cause.camera_std = cause.camera / std::sqrt(2.0 * count);
  cause.arm_std = cause.arm / std::sqrt(2.0 * std::max(fit.arm_freedom, 1.0));
  return cause;
}

PictureResidual residual_of_view(const BundleFit& fit, const RigBundle& bundle, std::size_t i,
                                 const std::string& name) {
  const BundleView& view = bundle.views[i];
  const Pose& T_base_flange = fit.model.T_base_flange[i];
  const auto errors = board_errors(fit.model, view, view.T_base_flange);
  return {.view = name,
          .pixel_rms = fit.view_rms[i],
          .board_mean = spread_of(errors).mean,
          .T_base_flange = T_base_flange,
          .T_base_camera = fit.model.mount == CameraMount::arm
                               ? T_base_flange * fit.model.T_mount_camera
                               : fit.model.T_mount_camera,
          .arm_position = translation_distance(view.T_base_flange, T_base_flange),
          .arm_rotation = rotation_distance(view.T_base_flange, T_base_flange)};
}

void add_picture_notes(const Board& board, const PosedViews& posed, PictureRig& rig) {
  std::vector<std::string>& notes = rig.hand_eye.notes;
  if (rig.hand_eye.cause.arm > kMaxArmError &&
      rig.hand_eye.cause.arm > 2.0 * rig.hand_eye.cause.camera) {
    notes.insert(
        notes.begin(),
        fmt::format("the arm's poses are off by {:.1f} mm and {:.2f} degrees rms, an arm by 1 mm "
                    "or less: they "
                    "may be commanded, not measured, or of another instant; for each picture trust "
                    "the pose that the board shows (views in the calibration)",
                    1e3 * std::sqrt(3.0) * rig.arm_position_std,
                    kDegrees * std::sqrt(3.0) * rig.arm_rotation_std));
  }
  if (rig.hand_eye.is_board_scale_used) {
    notes.push_back(fmt::format("by the arm's motion this is a {}",
                                describe(scaled(board, rig.hand_eye.board_scale))));
  }
  for (std::size_t i = 0; i < posed.views.size(); ++i) {
    if (!rig.hand_eye.residuals[i].is_outlier) continue;
    const auto degrees = turned_degrees(board, posed.views[i], rig.hand_eye);
    if (!degrees) continue;
    notes.push_back(fmt::format("in {} the board is turned by {} degrees against the others{}",
                                posed.views[i].name, *degrees,
                                *degrees == 180 ? ": upside down" : ""));
  }
}

RigBundle bundle_of(const PosedViews& posed, const Board& board, const HandEyeResult& found,
                    const CameraModel& camera, const PictureRigOptions& options) {
  RigBundle bundle;
  bundle.start = {.mount = options.hand_eye.mount,
                  .camera = camera,
                  .T_mount_camera = found.camera.T_a_b,
                  .T_fixed_board = found.board.T_a_b};
  bundle.options.with_scale = found.is_board_scale_used;
  if (found.is_board_scale_used) bundle.start.board_scale = found.board_scale;
  if (!options.camera) {
    const BundleOptions freed = camera_freedom(options.intrinsics);
    bundle.options.with_camera = true;
    bundle.options.lens = freed.lens;
  }
  for (std::size_t i = 0; i < posed.views.size(); ++i) {
    if (found.residuals[i].is_outlier) continue;
    bundle.views.push_back(bundle_view(posed.given[i], posed.views[i], board, camera));
    bundle.start.T_base_flange.push_back(posed.given[i].T_base_flange);
  }
  bundle.noise.arm_position = std::max(found.noise.arm_position, 1e-4);
  bundle.noise.arm_rotation = std::max(found.noise.arm_rotation, 1e-4);
  return bundle;
}

struct RigFit {
  RigBundle bundle = {};
  BundleFit fit = {};
  DistanceSpread left_out = {};

  explicit RigFit(RigBundle given)
      : bundle(std::move(given)),
        fit(fit_bundle(bundle.views, bundle.start, bundle.noise, bundle.options)),
        left_out(left_out_spread(bundle, fit)) {}
};

/// The same views with an arm that is exact: what is left is the pictures', whose errors are not
/// independent from point to point where a lens or a board is not what it is taken for. Then a fit
/// that weighs each point for itself blames the arm.
RigFit with_exact_arm(const RigFit& free) {
  RigBundle bundle = free.bundle;
  bundle.start.camera = free.fit.model.camera;
  bundle.options.with_scale = false;
  bundle.start.board_scale = 1.0;
  bundle.options.with_arm_noise = false;
  bundle.noise = {.arm_position = kExactPosition, .arm_rotation = kExactRotation};
  return RigFit(std::move(bundle));
}

/// The explanation by which the arm's poses predict unseen views better.
RigFit better_explanation(RigFit free) {
  if (free.left_out.mean <= 0.0) return free;
  RigFit exact = with_exact_arm(free);
  return exact.left_out.mean < kClearlyBetter * free.left_out.mean ? exact : free;
}

/// What the poses of single pictures showed of the board's size, and with it of the next pose, does
/// not hold.
void describe_exact_arm(const RigFit& explained, HandEyeResult& found) {
  if (found.is_board_scale_used) {
    found.is_board_scale_used = false;
    std::erase(found.notes, board_scale_note(found));
  }
  found.next.reset();
  found.notes.push_back(fmt::format(
      "unseen views are predicted to {:.1f} mm where the arm's poses count as exact, and "
      "not as well where they have errors of their own: what is left, {:.2f} px, is the "
      "pictures' (lens, board that is not flat, stamps)",
      1e3 * explained.left_out.mean, explained.fit.noise.pixel));
}

PictureRig rig_of(const PosedViews& posed, const Board& board, HandEyeResult found,
                  const RigFit& explained) {
  const auto& [bundle, fit, left_out] = explained;
  if (!bundle.options.with_arm_noise) describe_exact_arm(explained, found);
  PictureRig rig{.camera = fit.model.camera,
                 .is_camera_estimated = bundle.options.with_camera,
                 .pixel_noise = fit.noise.pixel,
                 .arm_position_std = fit.noise.arm_position,
                 .arm_rotation_std = fit.noise.arm_rotation};
  found.camera =
      calibrated_by(fit.model.T_mount_camera, fit.covariance.block<6, 6>(0, 0), found.camera);
  found.board =
      calibrated_by(fit.model.T_fixed_board, fit.covariance.block<6, 6>(6, 6), found.board);
  if (bundle.options.with_scale) {
    found.board_scale = fit.model.board_scale;
    found.board_scale_std = std::sqrt(fit.covariance(kScaleParameter, kScaleParameter));
  }
  found.cause = cause_by_pixels(fit, bundle.views, board);
  if (rig.is_camera_estimated) {
    const auto count = 4 + static_cast<Eigen::Index>(rig.camera.distortion.coefficients().size());
    for (Eigen::Index i = 0; i < count; ++i) {
      rig.camera_stds.push_back(
          std::sqrt(fit.covariance(kCameraParameter + i, kCameraParameter + i)));
    }
  }
  std::vector<double> distances;
  std::size_t fitted = 0;
  for (std::size_t i = 0; i < posed.views.size(); ++i) {
    if (found.residuals[i].is_outlier) continue;
    rig.views.push_back(residual_of_view(fit, bundle, fitted, posed.views[i].name));
    const BundleView& view = bundle.views[fitted++];
    const auto errors = board_errors(fit.model, view, view.T_base_flange);
    distances.insert(distances.end(), errors.begin(), errors.end());
  }
  rig.fitted = spread_of(distances);
  rig.left_out = left_out;
  rig.hand_eye = std::move(found);
  add_picture_notes(board, posed, rig);
  return rig;
}

}  // namespace

Expected<PictureRig> calibrate_picture_rig(const std::vector<ArmPicture>& views, int width,
                                           int height, const Board& board,
                                           const PictureRigOptions& options) {
  CameraModel camera;
  if (options.camera) {
    camera = *options.camera;
  } else {
    BoardViews seen{.width = width, .height = height};
    for (const ArmPicture& view : views) seen.views.push_back(view.board);
    const Expected<CameraCalibration> intrinsics =
        calibrate_camera(seen, board, options.intrinsics);
    if (!intrinsics) return intrinsics.error();
    camera = intrinsics->camera;
  }
  const PosedViews posed = pose_views(views, board, camera);
  Expected<HandEyeResult> found = calibrate_hand_eye(posed.views, options.hand_eye);
  if (!found) return found.error();
  const RigFit explained =
      better_explanation(RigFit(bundle_of(posed, board, *found, camera, options)));
  return rig_of(posed, board, *std::move(found), explained);
}

}  // namespace pcavr
