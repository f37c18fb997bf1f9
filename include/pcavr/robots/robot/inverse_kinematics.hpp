// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/robots/robot/options.cpp for meanings, ranges and defaults.
struct InverseKinematicsOptions {
  InverseKinematicsOptions();

  double position_tolerance;  ///< [m]
  double rotation_tolerance;  ///< [rad]
  double rotation_length;     ///< [m/rad]
  double singular_value;      ///< [m/rad]
  double max_damping;         ///< [m/rad]
  double max_step;            ///< [rad] or [m]
  double centring_gain;
  int max_iterations;
  int max_restarts;
};

/// The options "robot.inverse_kinematics".
[[nodiscard]] OptionSection section_of(InverseKinematicsOptions& options);

enum class IkStatus {
  kReached,     ///< both errors are within their tolerances
  kNotReached,  ///< out of reach, or behind limits of joints: q is the nearest that was found
};

struct IkResult {
  IkStatus status = IkStatus::kNotReached;
  double position_error = 0.0;  ///< [m]
  double rotation_error = 0.0;  ///< [rad]
  int iterations = 0;           ///< of all starts
  int restarts = 0;
  bool is_singular = false;  ///< a singular value of the Jacobian is below `singular_value`
  bool is_at_limit = false;  ///< at least one joint is at a limit of its position
};

/// The joint positions that bring a link to a pose: closed-loop inverse kinematics by damped least
/// squares [Wampler 1986; Nakamura & Hanafusa 1986], damped near singularities only [Maciejewski &
/// Klein 1988: numerical filtering by singular value]. A joint that would leave its limits stays at
/// them, and the others take over its part. What the pose leaves free (the seventh joint of an arm)
/// goes to the secondary goal: the least sum of ((q - middle) / range)^2 over the joints with
/// limits, by the gradient in the null space [Liegeois 1977].
///
/// After the constructor nothing allocates. Threads: one at a time per object. Same input, same
/// result: restarts are drawn from a fixed seed.
class InverseKinematics {
 public:
  /// Throws ContractError for an unknown link.
  InverseKinematics(const RobotModel& model, std::size_t link,
                    const InverseKinematicsOptions& options = {});
  InverseKinematics(InverseKinematics&&) noexcept;
  InverseKinematics& operator=(InverseKinematics&&) noexcept;
  ~InverseKinematics();

  /// Searches from `q` (moved into its limits first) and, if that gets stuck, from random
  /// positions; `q` is the result. The secondary goal is at a local optimum where kReached. Throws
  /// ContractError for a wrong size or numbers not finite.
  IkResult solve(const Pose& T_base_target, Eigen::Ref<Eigen::VectorXd> q);

  /// One cycle of a control loop: towards the target from `q`, with no joint faster than its limit
  /// of velocity (all are slowed down alike, so that the direction stays) over `dt` [s]. No
  /// restarts.
  IkResult follow(const Pose& T_base_target, double dt, Eigen::Ref<Eigen::VectorXd> q);

  /// The secondary goal's value: 0 where all joints are in the middle of their range.
  [[nodiscard]] double distance_to_middle(const Eigen::Ref<const Eigen::VectorXd>& q) const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace pcavr
