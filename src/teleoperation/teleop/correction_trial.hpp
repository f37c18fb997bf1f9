// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/contact.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/message.hpp"

namespace pcavr {

/// A correction of one body's pose, with its uncertainty, to be tried.
struct TriedCorrection {
  double t = 0.0;      ///< [s] time that it corrects
  double until = 0.0;  ///< [s] time that the operator's site predicts when it arrives
  std::size_t object = 0;
  std::vector<PlanarPose> poses;                    ///< of all objects at `t`, this one's corrected
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< [vx vy omega]
  BodyPhysics physics;                              ///< that the operator's site will have
  Eigen::Vector3d lateral_base =
      Eigen::Vector3d::UnitY();  ///< horizontal, across the push: there contact fixes nothing
  double position_std = 0.0;     ///< [m] along it
  double rotation_std = 0.0;     ///< [rad]
  std::function<Eigen::Vector3d(double)> p_base_tip;  ///< at any time [s]
};

/// A contact up to now, in which a correction's parameters are tried. A copy: a thread uses it.
struct TriedContact {
  Contact contact;                ///< `force` less its bias, and the object's first poses
  double force_resolution = 0.0;  ///< [N] below it no difference counts
  std::function<Eigen::Vector3d(double)> p_base_tip = {};  ///< at any time [s]
  BodyPhysics before = {};                                 ///< with the operator's parameters
  BodyPhysics after = {};                                  ///< with the correction's
};

/// The parts of one correction that are tried.
struct CorrectionProposal {
  std::optional<TriedCorrection> pose;  ///< empty: it is sent as it is
  double pose_error = 0.0;              ///< [m] of the pose that the operator's site has
  std::vector<TriedContact> contacts;   ///< empty: parameters are sent as they are

  [[nodiscard]] bool is_empty() const { return !pose && contacts.empty(); }
};

struct TrialResult {
  bool rejects_pose = false;        ///< it would be worse than the error when it is displayed
  bool rejects_parameters = false;  ///< a contact would have been predicted worse
};

/// A copy of the operator's world without the scan, in which corrections are tried before they are
/// sent. Some pushes are unstable, at a vertex above all: there the tracking's noise grows many
/// times over while a correction travels, and the display jumps farther than it erred.
class CorrectionTrial {
 public:
  /// The series of `world` are not used.
  CorrectionTrial(const TeleopInput& world, const std::vector<BodyPhysics>& physics,
                  const TeleopOptions& options);

  [[nodiscard]] TrialResult evaluate(const CorrectionProposal& proposal);
  /// [m] Std of the correction's pose, grown until the correction is displayed; a rotation counts
  /// at `rotation_radius`. Empty if there is no copy of the world.
  [[nodiscard]] std::optional<double> displayed_std(const TriedCorrection& tried);

  /// Error of the prediction of a contact with these parameters against what was measured, in
  /// position and force along the push together; 1 where either site would notice. Across the push
  /// and in rotation a push at one point is unstable: there, errors grow from those of the pose.
  /// Empty without a copy of the world, or where the object was not tracked.
  [[nodiscard]] std::optional<double> error_of(const TriedContact& tried,
                                               const BodyPhysics& physics);

 private:
  [[nodiscard]] Eigen::Vector3d end_of(const TriedCorrection& tried, double lateral,
                                       double rotation);

  std::optional<PredictedWorld> world_;
  std::vector<BodyState> untouched_;  ///< of the world at the start
  std::vector<Pose> T_base_starts_;
  double rotation_radius_;  ///< [m]
  double position_stds_;
  double min_position_error_;  ///< [m]
  double force_tolerance_;
  double step_;  ///< [s]
};

}  // namespace pcavr
