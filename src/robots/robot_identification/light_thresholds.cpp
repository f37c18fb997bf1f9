// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/light_thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pcavr {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Time constants of observer and filter that a joint's motion is remembered for.
constexpr double kMemoryTimes = 3.0;
/// Errors of either sign that show how large errors become: the margin of 10 is 2.4 with the
/// default spacing. Fewer do for a slow joint, as Coulomb's friction limits its threshold from
/// below.
constexpr int kMinExcursions = 10, kMinSlowExcursions = 6;

/// [N m] never 0, which no torque could stay below.
constexpr double kMinThreshold = 1e-6;

enum class JointMotion { moving, slow, unknown };

/// The motion of a joint, row by row; unknown outside the range of the rows before `first_judged`.
std::vector<JointMotion> motions(const LightThresholdInput& input, Eigen::Index joint,
                                 const ContactObserverOptions& options) {
  const auto first = static_cast<Eigen::Index>(input.first_judged);
  const auto q = input.log.position.col(joint), dq = input.velocity.col(joint);
  const double min_q = q.head(first).minCoeff(), max_q = q.head(first).maxCoeff();
  const double min_dq = dq.head(first).minCoeff(), max_dq = dq.head(first).maxCoeff();
  const double memory = kMemoryTimes * (1.0 / options.gain + options.filter_time);
  double last_slow = -kInfinity, last_unknown = -kInfinity;
  std::vector<JointMotion> found;
  found.reserve(input.log.t.size());
  for (std::size_t row = 0; row < input.log.t.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    const double t = input.log.t[row];
    if (std::abs(dq[i]) < options.slow_speed) last_slow = t;
    if (q[i] < min_q || q[i] > max_q || dq[i] < min_dq || dq[i] > max_dq) last_unknown = t;
    if (t - last_unknown < memory) {
      found.push_back(JointMotion::unknown);
    } else {
      found.push_back(t - last_slow < memory ? JointMotion::slow : JointMotion::moving);
    }
  }
  return found;
}

/// The errors of a joint's filtered torque in one kind of motion.
struct TorqueErrors {
  double largest = 0.0;     ///< [N m]
  double unresolved = 0.0;  ///< [N m] largest
  int excursions = 0;       ///< errors of either sign
  bool is_positive = false;

  void add(double torque, double not_resolved) {
    largest = std::max(largest, std::abs(torque));
    unresolved = std::max(unresolved, not_resolved);
    if (excursions == 0 || is_positive != (torque > 0.0)) ++excursions;
    is_positive = torque > 0.0;
  }
  [[nodiscard]] double threshold(double spacing, int min_excursions) const {
    if (excursions < min_excursions) return kInfinity;
    const double margin = std::sqrt(std::log(spacing) / std::log(excursions));
    return std::max(margin * largest, kMinThreshold);
  }
};

struct JointErrors {
  TorqueErrors moving, slow;
};

JointErrors errors_of(const LightThresholdInput& input, Eigen::Index joint,
                      const std::vector<JointMotion>& motion,
                      const ContactObserverOptions& options) {
  JointErrors errors;
  for (std::size_t row = 0; row < input.first_judged; ++row) {
    if (!input.without.is_filter_settled(row, options)) continue;
    const auto i = static_cast<Eigen::Index>(row);
    TorqueErrors& of_motion = motion[row] == JointMotion::slow ? errors.slow : errors.moving;
    of_motion.add(input.without.filtered(i, joint), input.without.filtered_unresolved(i, joint));
  }
  return errors;
}

}  // namespace

LightThresholds light_thresholds(const LightThresholdInput& input,
                                 const ContactObserverOptions& options) {
  const Eigen::Index rows = input.log.position.rows(), joints = input.log.position.cols();
  LightThresholds found{Eigen::MatrixXd::Zero(rows, joints),
                        Eigen::MatrixXd::Constant(rows, joints, kInfinity)};
  if (input.first_judged == 0) return found;
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    const std::vector<JointMotion> motion = motions(input, joint, options);
    const JointErrors errors = errors_of(input, joint, motion, options);
    const double moving = errors.moving.threshold(options.false_alarm_spacing, kMinExcursions);
    const double slow =
        std::max(errors.slow.threshold(options.false_alarm_spacing, kMinSlowExcursions),
                 std::isfinite(moving) ? moving : 0.0);
    for (std::size_t row = input.first_judged; row < input.log.t.size(); ++row) {
      if (motion[row] == JointMotion::unknown) continue;
      if (!input.judged.is_filter_settled(row, options)) continue;
      const auto i = static_cast<Eigen::Index>(row);
      const bool is_slow = motion[row] == JointMotion::slow;
      found.threshold(i, joint) = is_slow ? std::max(slow, input.coulomb(i, joint)) : moving;
      // The part that there was without contact is in the threshold already.
      const double usual = is_slow ? errors.slow.unresolved : errors.moving.unresolved;
      const double not_resolved = input.judged.filtered_unresolved(i, joint) - usual;
      found.torque(i, joint) =
          std::abs(input.judged.filtered(i, joint)) - std::max(0.0, not_resolved);
    }
  }
  return found;
}

}  // namespace pcavr
