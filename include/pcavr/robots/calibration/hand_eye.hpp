// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// One pose of the arm, and of a board that its camera sees then.
struct HandEyeView {
  std::string name;  ///< as messages name it: "view 7"
  Pose T_base_flange = {};
  Pose T_camera_board = {};
};

/// What carries the camera. The board is fixed to the other one: in the base, or on the flange.
enum class CameraMount { arm, base };

struct HandEyeOptions {
  CameraMount mount = CameraMount::arm;
  /// Random splits of the views for the held-out error: two thirds are fitted, the rest is judged.
  int splits = 50;
  std::uint64_t seed = 1;  ///< of the splits

  friend bool operator==(const HandEyeOptions&, const HandEyeOptions&) = default;
};

/// Standard deviations of what scatters the views, separated by how each acts: the arm's in the
/// base, alike for all views, its rotation by the lever to the board; the camera's in its own
/// frame, growing with the board's distance d.
struct HandEyeNoise {
  double arm_position = 0.0;     ///< [m]
  double arm_rotation = 0.0;     ///< [rad]
  double camera_across = 0.0;    ///< [rad] position across the line of sight is this times d
  double camera_depth = 0.0;     ///< [1/m] position along it is this times d^2
  double camera_rotation = 0.0;  ///< [rad]
};

/// What is known of the cause of the residuals, as an rms of the board's position [m].
struct HandEyeCause {
  double camera = 0.0, camera_std = 0.0;
  double arm = 0.0, arm_std = 0.0;
  bool is_separable = false;  ///< whether the residuals show whose they are
};

/// A pose with its covariance.
struct CalibratedPose {
  Pose T_a_b = {};
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist, as Pose has it
  /// Std of the position in a's axes [m]; nullopt: the motion does not show this coordinate.
  std::optional<double> position_std[3] = {};
  Eigen::Vector3d rotation_std = Eigen::Vector3d::Zero();  ///< [rad] about a's axes
};

struct HandEyeResidual {
  std::string view;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m] of the board, from its fitted pose
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad]
  double distance = 0.0;                               ///< [m] of the board from the camera
  bool is_outlier = false;                             ///< not fitted
  std::optional<std::string> partner = {};  ///< the view whose board pose fits this arm pose
};

/// A pose of the arm that would reduce the standard deviation of the camera's position.
struct NextPose {
  Pose T_base_flange = {};
  std::string text = {};  ///< "turn the camera by 40 degrees about the base's x axis ..."
  /// [m] in the direction in which it is largest; nullopt: not observable.
  std::optional<double> std_now = {};
  double std_expected = 0.0;  ///< [m]
};

struct HandEyeResult {
  CameraMount mount = CameraMount::arm;
  CalibratedPose camera = {};  ///< T_flange_camera, or T_base_camera
  CalibratedPose board = {};   ///< T_base_board, or T_flange_board
  /// True lengths over those of the board that were given: 1 where they agree.
  double board_scale = 1.0;
  double board_scale_std = 0.0;
  bool is_board_scale_used = false;  ///< it differs from 1 by more than its noise
  /// The point of the board [m] that the camera sees best, near its centre: errors of the board's
  /// rotation don't move it. Residuals and their rms are of this point.
  Eigen::Vector3d best_point_board = Eigen::Vector3d::Zero();
  HandEyeNoise noise = {};
  HandEyeCause cause = {};
  std::vector<HandEyeResidual> residuals = {};  ///< of all views
  double position_rms = 0.0;                    ///< [m] of the fitted views
  double rotation_rms = 0.0;                    ///< [rad]
  double leave_one_out_rms = 0.0;               ///< [m] each view's, by the others
  std::optional<double> held_out_rms = {};      ///< [m] over the splits; too few views: none
  /// The direction in the camera's carrier along which its position does not show.
  std::optional<Eigen::Vector3d> unobservable = {};
  std::optional<NextPose> next = {};
  std::vector<std::string> notes = {};  ///< for the user, the main ones first
};

/// Finds where the camera and the board are from views of one fixed board, by the equation
///     T_base_flange T_flange_camera T_camera_board = T_base_board
/// (camera on the arm; with the inverse of T_base_flange for a camera beside it). An Error where
/// the poses do not fit each other, with what they would fit as: inverted, in another unit,
/// mirrored; where they are all parallel, and where there are fewer than three.
[[nodiscard]] Expected<HandEyeResult> calibrate_hand_eye(const std::vector<HandEyeView>& views,
                                                         const HandEyeOptions& options = {});

/// rms [m] of the position of this point of the board in `views`, about that of `result`: of views
/// that were not fitted, what it is good for.
[[nodiscard]] double board_rms(const HandEyeResult& result, const std::vector<HandEyeView>& views,
                               const Eigen::Vector3d& point_board);

/// The note that the board's scale was found by the arm's motion, and used.
[[nodiscard]] std::string board_scale_note(const HandEyeResult& result);

/// One sentence of cause: whose the residuals are, and what would help.
[[nodiscard]] std::string describe_cause(const HandEyeResult& result);

}  // namespace pcavr
