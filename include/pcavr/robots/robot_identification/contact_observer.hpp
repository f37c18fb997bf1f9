// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct ContactObserverOptions {
  ContactObserverOptions();
  double gain;          ///< [1/s] of the observer: its time constant is 1 / gain
  double margin;        ///< threshold over the largest external torque without contact
  double min_duration;  ///< [s] above the threshold
  double filter_time;   ///< [s] time constant of the further low pass that light touches are behind
  double slow_speed;    ///< [rad/s] friction's sign is uncertain below it
  double false_alarm_spacing;  ///< errors of either sign for each false alarm, were they Gaussian
};
[[nodiscard]] OptionSection section_of(ContactObserverOptions& options);

/// The external torque at the joints from positions, velocities and torques, without accelerations:
/// the generalised momentum p = M dq has the derivative dp/dt = tau - friction + C^T dq - g +
/// external, so r = gain (p - integral(tau - friction + C^T dq - g + r)) is the external torque
/// behind a low pass of first order [De Luca & Mattone 2005; De Luca et al. 2006, eq. 11]. C^T dq
/// is the derivative of M along the motion, times dq, less C dq [symmetry of M]. The torque of the
/// environment on the arm counts positive. Causal. After the constructor nothing allocates.
/// Threads: one at a time per object.
class ContactObserver {
 public:
  /// `robot`: identified (RobotFit::robot), `friction`: by joint, in its order.
  ContactObserver(const RobotModel& robot, const std::vector<JointFit>& friction,
                  const ContactObserverOptions& options = {});

  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  /// Starts anew: the external torque is 0.
  void reset(const Vector& q, const Vector& dq);
  /// A sample `dt` [s] > 0 after the last one; returns the external torque [N m].
  const Eigen::VectorXd& update(const Vector& q, const Vector& dq, const Vector& tau, double dt);
  /// [N m] by joint: how far the samples' spacing may have moved the external torque, or friction
  /// at rest hides it. A momentum or torque that leaves its straight continuation has changed
  /// between samples, at a time and by a way that they do not show (an arm that stops at once, at
  /// 100 Hz). A joint at rest is held by any friction up to Coulomb's.
  [[nodiscard]] const Eigen::VectorXd& unresolved() const { return unresolved_; }

 private:
  void compute_momentum(const Vector& q, const Vector& dq, Eigen::VectorXd& momentum);
  void update_unresolved(double dt);
  void update_rest(const Vector& q, double dt);

  RobotDynamics dynamics_;
  std::vector<JointFit> friction_;
  std::vector<FrictionSign> signs_;  ///< of friction, by joint
  double gain_;
  Eigen::VectorXd external_, integral_, momentum_, start_, rate_, ahead_, behind_, zero_, gravity_;
  Eigen::VectorXd bias_, q_shifted_, unresolved_;
  Eigen::VectorXd last_momentum_, last_rate_, last_step_, last_rate_step_;  ///< of the last sample
  Eigen::VectorXd rest_position_;                                           ///< [rad]
  Eigen::VectorXd rest_time_;  ///< [s] since it was left
  int samples_ = 0;            ///< since the start
};

/// The force at a point of a link that explains external torques at the joints best, each weighted
/// by its threshold: [N], in base axes; the torque at the point is 0. `jacobian`: 6 x dof of that
/// point. Nothing where the joints don't determine a force. Pure function.
[[nodiscard]] std::optional<Eigen::Vector3d> tip_force(const Matrix6Xd& jacobian,
                                                       const Eigen::VectorXd& external,
                                                       const Eigen::VectorXd& thresholds);

/// External torques along a log.
struct ObservedContacts {
  Eigen::MatrixXd external;    ///< [N m] row by row of the log
  Eigen::VectorXd thresholds;  ///< [N m] by joint, from the rows before `first_judged`
  /// [N m] row by row, behind the further low pass; what the samples do not resolve is taken off.
  Eigen::MatrixXd light_torque;
  Eigen::MatrixXd light_thresholds;  ///< [N m] of them; infinity where they are not judged
  std::size_t first_judged = 0;      ///< row
  struct JointTouch {
    double t = 0.0;                             ///< [s] of the log
    std::size_t joint = 0;                      ///< whose torque exceeds its threshold most
    std::optional<Eigen::Vector3d> force_base;  ///< [N] on the tip
  };
  std::vector<JointTouch> touches;  ///< in the rows from `first_judged` on
  /// [N m] by joint: a torque at this joint alone that exceeds a threshold of it; median over the
  /// judged rows.
  Eigen::VectorXd detectable_torque;
  /// [N] the force on the tip, along an axis of base, that some joint's threshold is exceeded by;
  /// median over the axes and the judged rows.
  double usual_detectable_force = 0.0;
  /// [N] the same along the axis where it is largest; mean over the judged rows.
  double detectable_force = 0.0;
};

/// "a force of 3.5 N is found, ...": the detectable forces, or that a force moves no joint.
[[nodiscard]] std::string detectable_force_text(const ObservedContacts& contacts);

/// Runs the observer over a log without contact before time `calibration_end` [s]: its largest
/// external torques there, times the margin, are the thresholds for the rows after it, and those of
/// the further low pass make thresholds that depend on the motion (light_thresholds.hpp). Each
/// stretch is judged by the fit without it, as the errors of rows that were fitted are too small.
/// Velocities of the log, else backward differences. `tip`: link. Pure function.
[[nodiscard]] ObservedContacts observe_contacts(const JointLog& log, const RobotModel& described,
                                                const RobotFit& fit, bool is_sign_changed,
                                                double calibration_end, std::size_t tip,
                                                const ContactObserverOptions& options = {});

}  // namespace pcavr
