// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/prediction/predictor.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/message.hpp"
#include "teleoperation/teleop/tip_deflection.hpp"

namespace pcavr {

/// Sent by the operator's site with each command: its prediction of one object for the time at
/// which the command will be executed, and the acknowledgement of the last correction.
struct Prediction {
  PlanarPose pose;
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();           ///< of the tip on the object [N]
  Eigen::Vector3d rendered_force_base = Eigen::Vector3d::Zero();  ///< the same after blending [N]
  MotionPhase phase = MotionPhase::free;
  std::uint8_t received = 0;  ///< sequence of the last correction received
};

/// Times during which an object could not follow the tip, and when that began [s].
struct HeldTimes {
  double blocked = 0.0;    ///< by the scan, see BodyState
  double saturated = 0.0;  ///< the tip's force was at its maximum
  double first_blocked = 0.0;
  double first_saturated = 0.0;
};

/// The operator's site, which displays and renders the predicted world. Time is the robot's: at
/// wall time w the operator's site predicts w + forward delay.
class OperatorSite {
 public:
  /// An Error if an object can't be made a body.
  [[nodiscard]] static Expected<OperatorSite> create(const TeleopInput& input,
                                                     const std::vector<BodyPhysics>& physics,
                                                     const TeleopOptions& options, double start,
                                                     const Eigen::Vector3d& p_base_tip);

  /// Queues a message that arrives at `arrival` [s] of the operator's wall clock.
  void enqueue(double arrival, std::vector<std::uint8_t> bytes);
  /// Applies a message that has arrived. One that is not newer than an earlier one of its object is
  /// ignored: it was repeated, or overtaken by a newer one. False for these, and for those that
  /// come too late for the history.
  bool apply(const CorrectionMessage& message);
  /// One cycle, with the messages that have arrived by `wall` [s].
  /// `a_base_tip` [m/s^2] is the tip's acceleration, for contacts with a mass.
  void step(double wall, const Eigen::Vector3d& p_base_tip,
            const Eigen::Vector3d& a_base_tip = Eigen::Vector3d::Zero());

  /// Sets how much the robot's tip gives way [m/N]: from now on `p_base_tip` of step() is the
  /// command, and the tip is where that and the forces of the objects put it.
  void set_tool_response(const TipResponse& response) { deflection_.set_response(response); }
  /// Places an object at rest, now.
  void place(std::size_t object, const Pose& T_base_object);

  [[nodiscard]] double now() const { return predictor_.now(); }
  [[nodiscard]] const PredictedWorld& world() const { return predictor_.world(); }
  [[nodiscard]] Prediction prediction(std::size_t object) const;
  [[nodiscard]] ShownBody shown(std::size_t object) const { return predictor_.shown(object); }
  [[nodiscard]] std::size_t late() const { return late_; }
  [[nodiscard]] const HeldTimes& held(std::size_t object) const { return held_[object]; }

 private:
  struct Known {
    CadModel model;
    Pose T_base_start;
    ObjectParameters parameters;
    std::optional<std::uint8_t> received = {};  ///< sequence of its newest correction
    double contact_mass = 0.0;                  ///< [kg] of the law mass_damper_spring
    double stribeck_speed = 0.0;                ///< [m/s] see RobotObject::unknown_objects_
  };
  OperatorSite(Predictor predictor, std::vector<Known> objects, double epoch, double history,
               const TeleopOptions& options)
      : predictor_(std::move(predictor)),
        objects_(std::move(objects)),
        epoch_(epoch),
        gravity_(options.gravity()),
        step_(options.predictor.step),
        unknown_objects_(options.unknown_objects),
        held_(objects_.size()),
        history_(history),
        rotation_radius_(options.messages.rotation_radius) {}
  [[nodiscard]] Eigen::Vector3d tip_force() const;  ///< that the tip exerts, of all objects [N]
  void count_held();
  /// Applies what a correction says of an object from now on: it came too late for its own time.
  void apply_from_now(const Correction& late);
  /// A body that a correction moved by more than `stated` [m] and what the tip has pushed since the
  /// corrected time is taken back towards where it was, `before`.
  void limit_motion(const CorrectionMessage& message, const PlanarPose& before, double stated);
  [[nodiscard]] double tip_path_since(double t) const;

  Predictor predictor_;
  std::vector<Known> objects_;
  double epoch_;
  double gravity_;  ///< [m/s^2]
  double step_;     ///< [s]
  PhysicsDefaults unknown_objects_;
  std::vector<HeldTimes> held_;
  DelayedMessages<std::vector<std::uint8_t>> arriving_;
  std::size_t late_ = 0;
  struct TimedTip {
    double t = 0.0;  ///< [s]
    Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  };
  std::deque<TimedTip> tips_;  ///< over the predictor's history
  double history_ = 0.0;       ///< [s]
  double rotation_radius_;     ///< [m]
  Eigen::Vector3d a_base_tip_ = Eigen::Vector3d::Zero();
  TipDeflection deflection_;
};

}  // namespace pcavr
