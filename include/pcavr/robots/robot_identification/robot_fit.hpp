// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct RobotFitOptions {
  RobotFitOptions();
  double train_share;        ///< first part of the log that is fitted; the rest is held out
  double huber_threshold;    ///< [std] residuals beyond count linearly
  double prior_mass_std;     ///< [kg] of each body about the model's, before the data
  double prior_offset_std;   ///< [m] of each centre of mass
  double min_gain;           ///< relative decrease of the error for a further friction term
  double usual_torque_lag;   ///< [s] a longer one is a warning of identify_robot
  double max_torque_lag;     ///< [s] that is removed; a longer one is an Error of identify_robot
  double smoothing_speed;    ///< [rad/s] of Coulomb friction's sign; 0: by cross-validation
  bool known_body;           ///< inertias are the model's; friction alone is fitted [paper A]
  bool is_physical;          ///< bodies with positive definite pseudo-inertia only
  bool is_extended;          ///< try Stribeck, load-dependent and further terms of friction
  bool are_couplings_tried;  ///< by identify_robot: find_couplings
};
[[nodiscard]] OptionSection section_of(RobotFitOptions& options);

/// The terms of a joint's friction, torque as a function of speed v = dq.
enum class FrictionTerm {
  offset,         ///< 1
  viscous,        ///< v
  coulomb,        ///< sign: tanh(v / smoothing), or by PreslidingSign
  motor_inertia,  ///< ddq
  stribeck,       ///< sign exp(-(v / stribeck_speed)^2)
  load,           ///< |rigid-body torque| sign
  quadratic,      ///< v |v|
  asymmetric,     ///< |v|: viscous friction that differs by direction
  ripple_sin,     ///< sin q
  ripple_cos,     ///< cos q
};
inline constexpr int kFrictionTerms = 10;
[[nodiscard]] const char* name_of(FrictionTerm term);
[[nodiscard]] const char* unit_of(FrictionTerm term);

struct FittedTerm {
  FrictionTerm term = FrictionTerm::offset;
  double value = 0.0;
  double std = 0.0;
  bool is_excited = false;  ///< the data reduce the std well below the prior's
};

/// Torque errors of one joint [N m], of the filtered signals.
struct TorqueError {
  double rms = 0.0;
  double relative = 0.0;  ///< rms error over rms torque
};

struct EstimatedLag {
  double value = 0.0;  ///< [s]
  double std = 0.0;    ///< [s]
};

/// The way in which Coulomb friction changes its sign.
struct SignModel {
  double smoothing_speed = 0.0;  ///< [rad/s] of tanh, where friction's state is not kept
  /// [rad] over which friction changes its sign after a reversal (PreslidingSign), where that
  /// explains the torques better than any speed; else 0.
  double presliding_displacement = 0.0;
  bool is_filtered = false;  ///< tanh with one of kSmoothingSpeeds: JointSignals::smoothed_sign
};

struct JointFit {
  std::string name;
  std::vector<FittedTerm> friction;  ///< the terms that were used
  SignModel sign;
  double stribeck_speed = 0.0;   ///< [rad/s] where the term is used
  double noise_std = 0.0;        ///< [N m] of the residual, training part
  double correlated_rows = 1.0;  ///< rows that count as one independent one
  EstimatedLag torque_lag;       ///< of its torques after all joints'; not removed
  EstimatedLag sliding_lag;      ///< the same without the rows about reversals
  TorqueError train, held_out;
  TorqueError plain_held_out;  ///< of plain least squares: unweighted, no prior, plain friction
  /// Offset, viscous and Coulomb friction with a sign that changes at once, next to the fitted
  /// curve over the fitted motion: comparable among fits with different terms, and with others'.
  std::vector<FittedTerm> equivalent;

  [[nodiscard]] double value_of(FrictionTerm term) const;  ///< 0 where it is not used
  /// Whether its torques seem out of step with the others', by more than `usual` [s]. Friction
  /// after reversals seems so, too.
  [[nodiscard]] bool seems_out_of_step(double usual) const;
  /// The same where the rows between reversals show it as well.
  [[nodiscard]] bool is_out_of_step(double usual) const;
  /// [s] The shortest lag that would seem out of step in 98 of 100 such logs.
  [[nodiscard]] double visible_lag(double usual) const;
};

/// A combination of inertial parameters that the torques of this robot can identify.
struct BaseParameter {
  std::string name;  ///< "Izz_2 + 0.1 m_3 ..."
  double value = 0.0;
  double std = 0.0;
  double prior_std = 0.0;
  bool is_excited = false;
};

/// The fit without the rows of a stretch of time: its errors there are those of a motion that it
/// has not seen.
struct LeftOutFit {
  double begin = 0.0, end = 0.0;  ///< [s] of the signals: the stretch
  std::vector<JointFit> joints;   ///< with the whole fit's terms of friction
  Eigen::VectorXd inertial_parameters;
};

struct RobotFit {
  std::vector<JointFit> joints;
  Eigen::VectorXd inertial_parameters;  ///< as RobotModel: see inertial_parameters()
  std::vector<BaseParameter> base_parameters;
  bool is_physical = false;          ///< every body's pseudo-inertia is positive definite
  std::size_t train_rows = 0;        ///< the first rows of the signals
  Eigen::MatrixXd fitted_torque;     ///< [N m] row by row of the signals
  double torque_lag = 0.0;           ///< [s] of the torques after the positions; was removed
  double torque_lag_std = 0.0;       ///< [s]
  Eigen::VectorXd prior_std;         ///< of the inertial parameters
  double prior_scale = 1.0;          ///< factor of the prior's std that cross-validation chose
  std::vector<LeftOutFit> left_out;  ///< of stretches that make up the fitted part

  [[nodiscard]] std::size_t excited_base_parameters() const;
  /// The model with these inertias, for dynamics; armature is the motor inertia.
  [[nodiscard]] RobotModel robot(const RobotModel& described) const;
};

/// The model with fitted inertias; armature is the motor inertia.
[[nodiscard]] RobotModel fitted_robot(const RobotModel& described,
                                      const Eigen::VectorXd& inertial_parameters,
                                      const std::vector<JointFit>& joints);

/// Friction torque of a joint at position q [rad], speed v [rad/s], without motor inertia. `load`:
/// the rigid-body torque [N m]; `sign`: of Coulomb friction, by default that of the speed.
[[nodiscard]] double friction_torque(const JointFit& joint, double q, double v, double load);
[[nodiscard]] double friction_torque(const JointFit& joint, double q, double v, double load,
                                     double sign);

/// The sign of a joint's Coulomb friction, row by row of the signals. `joint`: their column.
[[nodiscard]] Eigen::VectorXd friction_sign(const SignModel& model, const JointSignals& signals,
                                            std::size_t joint);

/// The sign of a joint's Coulomb friction while the joint moves.
class FrictionSign {
 public:
  /// `start`: where it has a state, that at the start, -1 to 1.
  explicit FrictionSign(const SignModel& model, double start = 0.0);

  void move(double step);                            ///< by `step` [rad]
  [[nodiscard]] double at(double v) const;           ///< v [rad/s]
  [[nodiscard]] double slope(double towards) const;  ///< over the displacement [1/rad]

 private:
  double smoothing_speed_;
  std::optional<PreslidingSign> presliding_;
};

/// Fits inertial parameters and friction by weighted, robust least squares with a weak prior about
/// the model's inertias. The model has exactly the joints of the signals, in their order, without
/// mimic joints. Friction terms are selected by cross-validation within the training part alone.
/// Deterministic; pure function.
[[nodiscard]] RobotFit fit_robot(const JointSignals& signals, const RobotModel& model,
                                 const RobotFitOptions& options);

}  // namespace pcavr
