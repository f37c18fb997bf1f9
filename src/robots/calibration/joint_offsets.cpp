// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/joint_offsets.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "robots/calibration/calibrated_pose.hpp"

namespace pcavr {
namespace {

/// An offset whose std is this part of its prior's is one that rig's poses make up for.
constexpr double kHeldRatio = 0.99;
constexpr int kArmIterations = 60;
constexpr int kArmVarianceSteps = 3;    ///< of an iteration
constexpr double kMinArmChange = 1e-4;  ///< of the variances, by their share in the residual
constexpr double kMinArmStep = 1e-4;    ///< of the parameters, in their stds
/// [m] Std of the board's best point, which was chosen by the same residuals, about its origin.
constexpr double kPointStd = 0.15;
constexpr Eigen::Index kPointParameters = 3;
constexpr std::size_t kMinArmViews = 4;  ///< and one for each two joints: six coordinates each

/// What a fit needs to know of the arm and of the views; their board's frame is at its best point.
struct ArmViews {
  const std::vector<HandEyeView>& views;
  const ArmModel& arm;
  RigFitOptions options;
  double prior = 0.0;  ///< [rad]
};

struct ArmFit {
  RigFit fit = {};  ///< `covariance` is that of rig, offsets and best point
  Eigen::VectorXd offsets = {};
  std::vector<bool> is_held = {};
};

std::vector<ArmPose> arm_poses(const ArmViews& input, const Eigen::VectorXd& offsets) {
  std::vector<ArmPose> poses;
  for (std::size_t i = 0; i < input.views.size(); ++i) poses.push_back(input.arm(i, offsets));
  return poses;
}

std::vector<HandEyeView> placed_views(const ArmViews& input, const std::vector<ArmPose>& poses) {
  std::vector<HandEyeView> views = input.views;
  for (std::size_t i = 0; i < views.size(); ++i) views[i].T_base_flange = poses[i].T_base_flange;
  return views;
}

/// Derivatives of a view's residual by the offsets, in world's axes: the flange carries the board
/// that is seen where the camera is on the arm; where it is beside it, the base moves under the
/// flange the other way round.
RigJacobian by_offsets(const RigView& view, const ArmPose& pose, const Rig& rig,
                       CameraMount mount) {
  const bool is_on_arm = mount == CameraMount::arm;
  const Pose& T_base_flange = pose.T_base_flange;
  const Eigen::Vector3d p_world = board_by_view(view, rig).translation();
  const Eigen::Vector3d p_base = is_on_arm ? p_world : T_base_flange * p_world;
  const Eigen::Vector3d lever = p_base - T_base_flange.translation();
  const Eigen::Matrix3d R_flange_base = T_base_flange.rotation_matrix().transpose();
  RigJacobian jacobian = pose.jacobian_base;
  for (Eigen::Index joint = 0; joint < jacobian.cols(); ++joint) {
    const Eigen::Vector3d turn = jacobian.block<3, 1>(3, joint);
    jacobian.block<3, 1>(0, joint) += turn.cross(lever);
    if (is_on_arm) continue;
    jacobian.block<3, 1>(0, joint) = -R_flange_base * jacobian.block<3, 1>(0, joint).eval();
    jacobian.block<3, 1>(3, joint) = -R_flange_base * turn;
  }
  return jacobian;
}

/// By the rig's parameters, the offsets, and the best point: a shift of it in the board moves the
/// residual's position by the rotation's.
std::vector<LinearView> linearised(const ArmViews& input, const ArmFit& arm,
                                   const std::vector<std::size_t>& indices) {
  const std::vector<ArmPose> poses = arm_poses(input, arm.offsets);
  const std::vector<RigView> views = rig_views(placed_views(input, poses), input.options.mount);
  const Eigen::Matrix3d R_world_board = arm.fit.rig.T_world_board.rotation_matrix();
  std::vector<LinearView> linear =
      pcavr::linearised(views, indices, arm.fit.rig, input.options.mount);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    LinearView& view = linear[i];
    const RigJacobian of_rig = view.jacobian;
    view.jacobian.setZero(6, kRigParameters + arm.offsets.size() + kPointParameters);
    view.jacobian << of_rig,
        by_offsets(views[indices[i]], poses[indices[i]], arm.fit.rig, input.options.mount),
        RigJacobian::Zero(6, kPointParameters);
    view.jacobian.topRightCorner<3, 3>() = skew(view.residual.tail<3>()) * R_world_board;
  }
  return linear;
}

/// A basis of the parameters that are estimated: those of the rig, the offsets not held, and, where
/// asked for, the best point.
Eigen::MatrixXd basis_of(const ArmViews& input, const ArmFit& arm, bool with_point) {
  const Eigen::MatrixXd of_rig =
      estimated_basis(arm.fit, rig_views(input.views, input.options.mount), input.options);
  const Eigen::Index all = kRigParameters + arm.offsets.size() + kPointParameters;
  const auto free = std::count(arm.is_held.begin(), arm.is_held.end(), false);
  const Eigen::Index points = with_point ? kPointParameters : 0;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(all, of_rig.cols() + free + points);
  basis.topLeftCorner(of_rig.rows(), of_rig.cols()) = of_rig;
  Eigen::Index column = of_rig.cols();
  for (std::size_t joint = 0; joint < arm.is_held.size(); ++joint) {
    if (arm.is_held[joint]) continue;
    basis(kRigParameters + static_cast<Eigen::Index>(joint), column++) = 1.0;
  }
  basis.bottomRightCorner(points, points).setIdentity();
  return basis;
}

Eigen::MatrixXd covariance_in(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& information) {
  const Eigen::MatrixXd reduced = basis.transpose() * information * basis;
  const Eigen::MatrixXd inverse =
      reduced.ldlt().solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));
  return basis * inverse * basis.transpose();
}

/// A Gauss-Newton step of rig and offsets at these variances; keeps the covariance in `arm`, which
/// contains that the best point was chosen by the same residuals.
Eigen::VectorXd solve_step(const ArmViews& input, const std::vector<LinearView>& linear,
                           ArmFit& arm) {
  const Eigen::Index joints = arm.offsets.size();
  const Eigen::Index all = kRigParameters + joints + kPointParameters;
  const double certainty = 1.0 / (input.prior * input.prior);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(all, all);
  information.diagonal().segment(kRigParameters, joints).setConstant(certainty);
  information.diagonal().tail(kPointParameters).setConstant(1.0 / (kPointStd * kPointStd));
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(all);
  gradient.segment(kRigParameters, joints) = certainty * arm.offsets;
  for (const LinearView& view : linear) {
    const RigJacobian weighted =
        covariance_of(view.shape, arm.fit.variances).inverse() * view.jacobian;
    information += weighted.transpose() * view.jacobian;
    gradient += weighted.transpose() * view.residual;
  }
  arm.fit.covariance = covariance_in(basis_of(input, arm, true), information);
  return -covariance_in(basis_of(input, arm, false), information) * gradient;
}

/// Rig, offsets and variances, in turns, of the views of these indices.
void refine(const ArmViews& input, const std::vector<std::size_t>& indices, ArmFit& arm) {
  arm.fit.used = indices;
  for (int iteration = 0; iteration < kArmIterations; ++iteration) {
    const Eigen::VectorXd step = solve_step(input, linearised(input, arm, indices), arm);
    arm.fit.rig = moved(arm.fit.rig, step.head(kRigParameters));
    arm.offsets += step.segment(kRigParameters, arm.offsets.size());
    const std::vector<LinearView> at = linearised(input, arm, indices);
    const Variances before = arm.fit.variances;
    for (int i = 0; i < kArmVarianceSteps; ++i) {
      arm.fit.variances = improved(at, arm.fit.covariance, arm.fit.variances);
    }
    const Eigen::Index moving = kRigParameters + arm.offsets.size();
    const double stds = std::sqrt(arm.fit.covariance.diagonal().head(moving).sum());
    if (variance_change(at.front().shape, before, arm.fit.variances) < kMinArmChange &&
        step.norm() < 1e-9 + kMinArmStep * stds) {
      return;
    }
  }
}

double offset_std(const ArmFit& arm, Eigen::Index joint) {
  const Eigen::Index at = kRigParameters + joint;
  return std::sqrt(std::max(arm.fit.covariance(at, at), 0.0));
}

/// Holds the offsets that the views do not show, and fits again without them.
void hold_unseen(const ArmViews& input, ArmFit& arm) {
  for (Eigen::Index joint = 0; joint < arm.offsets.size(); ++joint) {
    if (offset_std(arm, joint) < kHeldRatio * input.prior) continue;
    arm.is_held[static_cast<std::size_t>(joint)] = true;
    arm.offsets[joint] = 0.0;
  }
  refine(input, arm.fit.used, arm);
}

std::vector<std::size_t> fitted_views(const HandEyeResult& found) {
  std::vector<std::size_t> fitted;
  for (std::size_t i = 0; i < found.residuals.size(); ++i) {
    if (!found.residuals[i].is_outlier) fitted.push_back(i);
  }
  return fitted;
}

/// The rig of a result at its best point, as a start.
ArmFit start_of(const HandEyeResult& found, Eigen::Index joints) {
  ArmFit arm;
  arm.fit.rig = {found.camera.T_a_b, found.board.T_a_b, found.board_scale};
  if (!found.is_board_scale_used) arm.fit.rig.board_scale = 1.0;
  arm.fit.rig.T_world_board =
      arm.fit.rig.T_world_board *
      Pose::from_translation(arm.fit.rig.board_scale * found.best_point_board);
  const HandEyeNoise& noise = found.noise;
  const double stds[] = {noise.arm_position, noise.arm_rotation, noise.camera_across,
                         noise.camera_depth, noise.camera_rotation};
  for (std::size_t source = 0; source < kSources; ++source) {
    arm.fit.variances[source] = stds[source] * stds[source];
  }
  arm.fit.unobservable = found.unobservable;
  arm.offsets = Eigen::VectorXd::Zero(joints);
  arm.is_held.assign(static_cast<std::size_t>(joints), false);
  return arm;
}

/// rms [m] of the board's position in views that were not fitted, over the splits.
std::optional<double> held_out(const ArmViews& input, const ArmFit& arm,
                               const HandEyeOptions& options) {
  double sum = 0.0, judged = 0.0;
  for (const ViewSplit& split : view_splits(arm.fit.used, options)) {
    ArmFit part = arm;
    refine(input, split.fitted, part);
    for (const LinearView& view : linearised(input, part, split.judged)) {
      sum += view.residual.head<3>().squaredNorm();
      judged += 1.0;
    }
  }
  return judged > 0.0 ? std::optional(std::sqrt(sum / judged)) : std::nullopt;
}

/// The fit of the same views with all offsets held at 0.
ArmFit without_offsets(const ArmViews& input, ArmFit arm) {
  arm.offsets.setZero();
  arm.is_held.assign(arm.is_held.size(), true);
  refine(input, std::vector<std::size_t>(arm.fit.used), arm);
  return arm;
}

/// Poses and stds of the fit in the place of those of the corrected arm alone.
void take_over(const ArmFit& arm, const Eigen::Vector3d& best_point, bool with_scale,
               HandEyeResult& result) {
  const RigFit& fit = arm.fit;
  result.camera =
      calibrated(fit.rig.T_mount_camera, fit.covariance.topLeftCorner<6, 6>(), std::nullopt);
  result.board =
      board_at_origin(fit.rig, fit.covariance.block<6, 6>(6, 6), best_point, std::nullopt);
  result.is_board_scale_used = with_scale;
  result.board_scale = with_scale ? fit.rig.board_scale : 1.0;
  result.board_scale_std = with_scale ? std::sqrt(std::max(fit.covariance(12, 12), 0.0)) : 0.0;
}

Error one_axis() {
  return {.message = "all rotations are about one axis: they do not show the joints' offsets",
          .place = "ROBOT",
          .hint = "add views with other tilts, or leave out --urdf"};
}

std::string held_note(const std::vector<JointOffset>& offsets) {
  std::string held;
  for (const JointOffset& offset : offsets) {
    if (offset.is_held) held += (held.empty() ? "" : ", ") + offset.joint;
  }
  return held.empty() ? held
                      : "the views do not show the offsets of " + held +
                            ": held at 0 (the first joint turns the whole arm, the last what it "
                            "carries)";
}

}  // namespace

Expected<ArmHandEyeResult> calibrate_hand_eye_and_arm(const std::vector<HandEyeView>& views,
                                                      const ArmModel& arm_model,
                                                      const std::vector<std::string>& joints,
                                                      const HandEyeOptions& options,
                                                      const JointOffsetOptions& offset_options) {
  PCAVR_REQUIRE(offset_options.std > 0.0, offset_options.std);
  if (views.size() < kMinArmViews + (joints.size() + 1) / 2) {
    return Error{.message = fmt::format("{} views are too few for the offsets of {} joints",
                                        views.size(), joints.size()),
                 .place = "ROBOT",
                 .hint = fmt::format("give {} and more", kMinArmViews + (joints.size() + 1) / 2)};
  }
  Expected<HandEyeResult> found = calibrate_hand_eye(views, options);
  if (!found) return found.error();
  ArmHandEyeResult result{.without = *found};
  ArmFit arm;
  // Which views fit, and the board's scale, are looked at again with the arm corrected.
  for (int round = 0; round < 2; ++round) {
    if (found->unobservable) return one_axis();
    std::vector<HandEyeView> moved_views = views;
    move_board(found->best_point_board, moved_views);
    const ArmViews input{moved_views,
                         arm_model,
                         {.mount = options.mount, .with_scale = found->is_board_scale_used},
                         offset_options.std};
    arm = start_of(*found, static_cast<Eigen::Index>(joints.size()));
    refine(input, fitted_views(*found), arm);
    hold_unseen(input, arm);
    const ArmViews plain{views, arm_model, input.options, offset_options.std};
    const std::vector<HandEyeView> corrected = placed_views(plain, arm_poses(plain, arm.offsets));
    const bool is_last = round > 0;
    if (is_last) {
      result.hand_eye.held_out_rms = held_out(input, arm, options);
      result.without.held_out_rms = held_out(input, without_offsets(input, arm), options);
    }
    const Eigen::Vector3d best_point = found->best_point_board;
    found = calibrate_hand_eye(corrected, options);
    if (!found) return found.error();
    if (!is_last) continue;
    const std::optional<double> unseen = result.hand_eye.held_out_rms;
    result.hand_eye = *found;
    result.hand_eye.held_out_rms = unseen;
    take_over(arm, best_point, input.options.with_scale, result.hand_eye);
  }
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const auto at = static_cast<Eigen::Index>(joint);
    const bool is_held = arm.is_held[joint];
    result.offsets.push_back(
        {joints[joint], arm.offsets[at], is_held ? 0.0 : offset_std(arm, at), is_held});
  }
  if (std::string note = held_note(result.offsets); !note.empty()) {
    result.hand_eye.notes.push_back(std::move(note));
  }
  return result;
}

std::string describe_offsets(const ArmHandEyeResult& result) {
  const auto& with = result.hand_eye.held_out_rms;
  const auto& without = result.without.held_out_rms;
  if (!with || !without) return "too few views to judge the offsets on unseen ones";
  return fmt::format("on unseen views {:.2f} mm with the joints' offsets, {:.2f} mm without",
                     1e3 * *with, 1e3 * *without) +
         (*with < *without ? "" : ": the arm is no better for them");
}

}  // namespace pcavr
