// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/prediction/body_physics.hpp"
#include "pcavr/teleop/run_teleop.hpp"

#include "teleop/body_surface.hpp"
#include "teleop/correction_switch.hpp"
#include "teleop/message.hpp"
#include "teleop/object_learner.hpp"
#include "teleop/phase_monitor.hpp"

namespace pcavr {

/// Tip and force at one instant, as the robot's site knows them.
struct TouchSample {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< bias removed [N]
};

/// By which the place of an object that moves unseen becomes less sure: of its way.
inline constexpr double kUnseenShare = 0.05;

/// Where the robot's site holds an object to be, and how surely.
struct KnownPlace {
  Pose T_base_object;
  double sigma = 0.0;      ///< along one axis [m]
  bool is_current = true;  ///< false: it moves, and was last seen some time before
};

/// All that the robot's site knows of one object.
class RobotObject {
 public:
  RobotObject(const TeleopObject& object, const BodyPhysics& assumed, const MonitorOptions& monitor,
              const SwitchOptions& gate, std::optional<double> force_ceiling, double tool_radius,
              double start);

  /// Takes in the frames up to `t` [s].
  void look(double t);
  [[nodiscard]] Reach reach(const Eigen::Vector3d& p_base_tip) const;
  /// Whether the camera alone has shown it moving lately.
  [[nodiscard]] bool is_seen_moving() const { return is_seen_moving_; }
  [[nodiscard]] bool is_lost(double t) const;

  /// Its place at a sample's instant: the latest frame, carried on by the object's way since, and
  /// while the tip presses, the face where force and contact law say it is, weighted by variances.
  /// What the touch told stays true until the camera sees the object move.
  [[nodiscard]] KnownPlace place_at(const TouchSample& sample);
  /// [vx vy omega] as known now.
  [[nodiscard]] Eigen::Vector3d twist() const;

  /// The physics in use at this site: what was learned, completed.
  [[nodiscard]] BodyPhysics physics() const;

  PhaseMonitor monitor;
  ObjectLearner learner;
  CorrectionSwitch gate;
  ObjectParameters told;  ///< what the operator's site has for certain
  struct OnItsWay {
    std::uint8_t sequence = 0;
    ObjectParameters parameters;
  };
  std::optional<OnItsWay> on_its_way = {};
  std::uint8_t sequence = 0;
  /// Another object moved along: the force is not this one's alone.
  bool is_shared = false;
  double last_learned = -1e300;  ///< [s]
  double learn_at = 1e300;       ///< [s] next time that something new may be there
  double withstood_since = 1e300;

  [[nodiscard]] const TeleopObject& source() const { return *source_; }

 private:
  [[nodiscard]] double way_since_frame(double t) const;

  const TeleopObject* source_;
  BodySurface surface_;
  /// As assumed at the start: its shape does not change on the way, and is dear to find.
  std::optional<LimitSurface> limit_surface_;
  double tool_radius_;
  std::size_t frames_ = 0;  ///< looked at
  TrackedPose latest_;
  double turn_rate_ = 0.0;  ///< [rad/s]
  bool is_seen_moving_ = false;
  double frame_interval_ = 0.033;
  Eigen::Vector3d touched_offset_ = Eigen::Vector3d::Zero();  ///< tracked to touched place [m]
  double touched_sigma_ = 0.0;                                ///< [m]; 0: never touched here
};

}  // namespace pcavr
