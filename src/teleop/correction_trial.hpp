// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/prediction/body_physics.hpp"
#include "pcavr/prediction/predicted_world.hpp"
#include "pcavr/teleop/run_teleop.hpp"

#include "teleop/message.hpp"
#include "teleop/parameter_trial.hpp"

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

/// A copy of the operator's world without the scan, in which corrections are tried before they are
/// sent. Some pushes are unstable, at a vertex above all: there the tracking's noise grows many
/// times over while a correction travels, and the display jumps farther than it erred.
class CorrectionTrial {
 public:
  /// Of `world` the series are not used.
  CorrectionTrial(const TeleopInput& world, const std::vector<BodyPhysics>& physics,
                  const TeleopOptions& options);

  /// [m] To what the std of the correction's pose grows until it is displayed; a rotation counts
  /// at `rotation_radius`. Empty if there is no copy of the world.
  [[nodiscard]] std::optional<double> displayed_std(const TriedCorrection& tried);

  /// Whether there is a copy of the world.
  [[nodiscard]] bool has_world() const { return world_.has_value(); }
  /// Goes on with the prediction of a contact by at most `steps` steps, which are taken from it.
  /// True at its end. Requires has_world().
  [[nodiscard]] bool advance(ContactRun& run, std::size_t& steps);
  /// How far the prediction of a contact was from what was measured, in position and force along
  /// the push together; 1 where either site would notice. Across the push and in rotation a push at
  /// one point is unstable: there, errors grow from those of the pose.
  [[nodiscard]] double error_of(const ContactRun& run) const;

 private:
  void begin(ContactRun& run);
  void compare(ContactRun& run, double t) const;
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
