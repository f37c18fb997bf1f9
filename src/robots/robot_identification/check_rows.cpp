// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "robots/robot_identification/log_units.hpp"

namespace pcavr {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLimitMargin = 0.05;   ///< [rad] beyond a limit that calibration may explain
constexpr double kDegreesShare = 0.01;  ///< of the rows beyond: fewer are spoiled rows
constexpr double kFastestJoint = 30.0;  ///< [rad/s] beyond the rating of any arm's joint
constexpr double kMissedTravel = 0.03;  ///< [rad] of some milliseconds that a logger missed
constexpr double kInMotion = 0.2;       ///< of the 95th percentile of steps: the joint moves
/// [quanta of the encoder] that a joint at rest may be apart in two rows: its position flickers by
/// one to either side, and is logged rounded.
constexpr double kFlicker = 3.0;
/// [rad/s] mean velocity of a standstill below which it may be the offset of a velocity at rest.
constexpr double kRestVelocity = 0.005;
constexpr Eigen::Index kStuckRows = 5;  ///< bit-identical rows in motion
constexpr double kStuckJump = 3.0;      ///< [steps before] by which a stuck joint returns
constexpr double kLongStuck = 0.1;      ///< [s] after which it may return on either side, or never
constexpr double kMaxPauses = 100.0;    ///< of the time in which rows follow each other
constexpr Eigen::Index kSaturatedRows = 5;   ///< at exactly the extreme
constexpr Eigen::Index kSaturatedRatio = 4;  ///< of those rows to those at the next value

Error finding(const JointLog& log, Eigen::Index joint, Eigen::Index row, std::string message,
              std::string hint) {
  return {.message = std::move(message),
          .line = log.lines[static_cast<std::size_t>(row)],
          .place = "joint " + log.joints[static_cast<std::size_t>(joint)],
          .hint = std::move(hint)};
}

/// Positions beyond the limits that would be inside them as degrees.
void check_degrees(const JointLog& log, const RobotModel& model, LogFindings& findings) {
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    const JointLimits& limits = model.joints[static_cast<std::size_t>(j)].limits;
    if (model.joints[static_cast<std::size_t>(j)].kind == JointKind::kPrismatic) continue;
    Eigen::Index row = 0;
    const double extreme = log.position.col(j).cwiseAbs().maxCoeff(&row);
    const double limit = limits.lower && limits.upper
                             ? std::max(std::abs(*limits.lower), std::abs(*limits.upper))
                             : 2.0 * kTurn;
    if (extreme <= limit + kLimitMargin) continue;
    const auto beyond = (log.position.col(j).array().abs() > limit + kLimitMargin).count();
    const bool is_degrees =
        extreme * kDegree <= limit + kLimitMargin && extreme > 2.0 * limit &&
        static_cast<double>(beyond) >= kDegreesShare * static_cast<double>(log.position.rows());
    const std::string range = fmt::format(
        "position {:.4g} is beyond the limit {:.4g} rad of the "
        "robot description",
        log.position(row, j), limit);
    if (is_degrees) {
      findings.errors.push_back(
          finding(log, j, row, range + ", and inside it as degrees", "write positions in radians"));
    } else {
      findings.warnings.push_back(finding(log, j, row, range, {}));
    }
  }
}

/// Removes jumps by full turns; reports other jumps that no arm can make.
void check_jumps(JointLog& log, const RobotModel& model, LogFindings& findings) {
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    if (model.joints[static_cast<std::size_t>(j)].kind == JointKind::kPrismatic) continue;
    const JointLimits& limits = model.joints[static_cast<std::size_t>(j)].limits;
    const double fastest = 3.0 * limits.velocity.value_or(kFastestJoint / 3.0);
    double turns = 0.0;
    std::size_t wraps = 0;
    Eigen::Index first_wrap = 0;
    for (Eigen::Index i = 1; i < log.position.rows(); ++i) {
      const double before = log.position(i - 1, j);
      double step = log.position(i, j) + turns - before;
      const auto at = static_cast<std::size_t>(i);
      const double room = fastest * (log.t[at] - log.t[at - 1]) + kMissedTravel;
      if (std::abs(step) > room && std::abs(step) > 0.5 * kTurn) {
        const double whole = kTurn * std::round(step / kTurn);
        if (std::abs(step - whole) <= std::max(room, 0.1)) {
          if (wraps++ == 0) first_wrap = i;
          turns -= whole;
          step -= whole;
        }
      }
      if (std::abs(step) > room) {
        findings.errors.push_back(finding(log, j, i,
                                          fmt::format("position jumps by {:.4g} rad in {:.3g} s",
                                                      step, log.t[at] - log.t[at - 1]),
                                          "remove these rows, or split the log there"));
        return;
      }
      log.position(i, j) += turns;
    }
    if (wraps == 0) continue;
    findings.warnings.push_back(finding(
        log, j, first_wrap,
        fmt::format("position wraps by full turns {} times from here; unwrapped", wraps), {}));
  }
}

/// Rows that repeat a position bit by bit: `first` is the first repetition.
struct Standstill {
  Eigen::Index first = 0, last = 0;
  double step = 0.0;    ///< [rad] a row before it
  double travel = 0.0;  ///< [rad] in the rows before it
};

/// Findings from a joint's column about its encoder and its motion.
struct PositionSteps {
  double quantum = 0.0;  ///< [rad] the smallest change: the encoder's, or that of rounding
  double moving = 0.0;   ///< [rad] a row, above which it moves; 0: it rests in all rows
};

PositionSteps position_steps(const Eigen::VectorXd& position) {
  PositionSteps found;
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < position.size(); ++i) {
    const double step = std::abs(position[i] - position[i - 1]);
    if (step == 0.0) continue;
    steps.push_back(step);
    if (found.quantum == 0.0 || step < found.quantum) found.quantum = step;
  }
  std::erase_if(steps, [&](double step) { return step < 1.5 * found.quantum; });
  if (steps.empty()) return found;
  const auto high = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() * 19 / 20);
  std::nth_element(steps.begin(), high, steps.end());
  found.moving = kInMotion * *high;
  return found;
}

/// Whether the joint was in motion before, and is elsewhere after: by a jump in its direction, or
/// after a long time by a jump to either side. No drive stops a moving joint between two rows, so
/// that a long standstill right after motion is enough where the log ends with it. An encoder's
/// flicker is neither motion nor a jump.
bool is_stuck(const JointLog& log, Eigen::Index j, const Standstill& still,
              const PositionSteps& steps) {
  if (steps.moving == 0.0 || !(std::abs(still.step) > steps.moving)) return false;
  if (still.travel <= kFlicker * steps.quantum) return false;
  const auto length = static_cast<double>(still.last - still.first + 1);
  const bool is_long =
      log.t[static_cast<std::size_t>(still.last)] - log.t[static_cast<std::size_t>(still.first)] >
      kLongStuck;
  if (still.last + 1 == log.position.rows()) return is_long;
  const double jump = log.position(still.last + 1, j) - log.position(still.last, j);
  if (std::abs(jump) <= kFlicker * steps.quantum) return false;
  if (!(std::abs(jump) > kStuckJump * std::abs(still.step))) return false;
  return is_long || (still.step * jump > 0.0 && jump / still.step > 0.3 * length);
}

/// [rad] that the recorded velocity makes of a standstill; 0 without velocities, and where it may
/// be an offset.
double missed_travel(const JointLog& log, Eigen::Index j, const Standstill& still) {
  if (log.velocity.rows() == 0) return 0.0;
  const double dt =
      log.t[static_cast<std::size_t>(still.last)] - log.t[static_cast<std::size_t>(still.first)];
  const Eigen::Index length = still.last - still.first + 1;
  const double velocity = std::abs(log.velocity.col(j).segment(still.first, length).mean());
  return velocity > kRestVelocity ? velocity * dt : 0.0;
}

/// A position that stays bit-identical while the joint moves.
std::optional<Error> stuck_joint(const JointLog& log, Eigen::Index j) {
  constexpr double kMaxTravel = 0.02;  // [rad]
  const auto q = [&](Eigen::Index i) { return log.position(i, j); };
  const Eigen::Index rows = log.position.rows();
  const PositionSteps steps = position_steps(log.position.col(j));
  for (Eigen::Index i = 2; i < rows; ++i) {
    if (q(i) != q(i - 1) || q(i - 1) == q(i - 2)) continue;
    const Eigen::Index back = std::max<Eigen::Index>(0, i - 6);
    const double travel_before = q(i - 1) - q(back);
    Standstill still{i, i, travel_before / static_cast<double>(i - 1 - back),
                     std::abs(travel_before)};
    while (still.last + 1 < rows && q(still.last + 1) == q(i)) ++still.last;
    i = still.last;
    const Eigen::Index length = still.last - still.first + 1;
    if (length < kStuckRows) continue;
    const double travel = missed_travel(log, j, still);
    if (travel <= kMaxTravel && !is_stuck(log, j, still, steps)) continue;
    const std::string rest = travel > kMaxTravel
                                 ? fmt::format(", in which its velocity makes {:.3g} rad", travel)
                                 : std::string(" while the joint moves");
    return finding(log, j, still.first,
                   fmt::format("position does not change for {} rows", length + 1) + rest,
                   "remove these rows, or repair the encoder's connection");
  }
  return std::nullopt;
}

/// A joint that never moves has no information, but is not a fault; one that never changes while
/// its velocity does is.
void check_stuck(const JointLog& log, LogFindings& findings) {
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    if (std::optional<Error> error = stuck_joint(log, j)) {
      findings.errors.push_back(*std::move(error));
    }
  }
}

/// Rows at exactly the largest value of a column.
struct ExtremeRows {
  double value = 0.0;
  Eigen::Index count = 0;               ///< with this value
  Eigen::Index next_count = 0;          ///< with the next smaller one
  Eigen::Index first = 0, longest = 0;  ///< of the longest run of such rows

  explicit ExtremeRows(const Eigen::VectorXd& column) : value(column.maxCoeff()) {
    double next = -std::numeric_limits<double>::infinity();
    Eigen::Index run = 0;
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      run = column[i] == value ? run + 1 : 0;
      if (run > longest) {
        longest = run;
        first = i - run + 1;
      }
      if (run > 0) {
        ++count;
      } else if (column[i] >= next) {
        next_count = column[i] > next ? 1 : next_count + 1;
        next = column[i];
      }
    }
  }
};

/// Torques that were cut off at a limit: far more rows have exactly their extreme than the value
/// next to it, whether noise leaves them in runs or not. Rounded peaks of a sine have up to 2.4
/// times as many; a logger that reads a slow controller repeats all values equally.
void check_saturation(const JointLog& log, const Eigen::MatrixXd& values, LogFindings& findings) {
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    for (const double sign : {1.0, -1.0}) {
      const ExtremeRows extreme(sign * values.col(j));
      if (extreme.count < kSaturatedRows || extreme.value == 0.0 || extreme.next_count == 0 ||
          extreme.count <= kSaturatedRatio * extreme.next_count) {
        continue;
      }
      // A joint at rest may repeat a torque; at its extreme, with others moving, it is a limit.
      const Eigen::Index from = std::max<Eigen::Index>(0, extreme.first - 20);
      const Eigen::Index to = std::min(values.rows() - 1, extreme.first + extreme.longest + 20);
      if ((log.position.row(to) - log.position.row(from)).norm() < 1e-3) continue;
      findings.errors.push_back(finding(log, j, extreme.first,
                                        fmt::format("torque or current saturates at {:.4g} in {} "
                                                    "rows",
                                                    sign * extreme.value, extreme.count),
                                        "repeat the motion more slowly, or remove these rows"));
    }
  }
}

void check_gaps(const JointLog& log, double max_gap, LogFindings& findings) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < log.t.size(); ++i) intervals.push_back(log.t[i] - log.t[i - 1]);
  const double usual = median(intervals);
  const double limit = std::max(max_gap, 2.5 * usual);
  std::size_t gaps = 0, first = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i] > limit && gaps++ == 0) first = i + 1;
  }
  if (gaps == 0) return;
  const auto longest = std::max_element(intervals.begin(), intervals.end());
  // The signals of all rows are on one grid, which takes as much memory as the time from the first
  // row to the last.
  if (log.t.back() - log.t.front() > kMaxPauses * usual * static_cast<double>(log.t.size())) {
    findings.errors.push_back(
        {.message = fmt::format("the time jumps by {:.3g} s", *longest),
         .line = log.lines[static_cast<std::size_t>(longest - intervals.begin() + 1)],
         .place = "t",
         .hint = "remove the rows of another time, or give each part alone"});
    return;
  }
  findings.warnings.push_back(
      {.message = fmt::format("{} gaps, the longest {:.3g} s; their surroundings are left out",
                              gaps, *longest),
       .line = log.lines[first],
       .place = "t"});
}

}  // namespace

LogFindings check_rows(JointLog& log, const RobotModel& model, double max_gap) {
  LogFindings findings;
  // Full turns leave the limits, too.
  JointLog unwrapped = log;
  LogFindings jumps;
  check_jumps(unwrapped, model, jumps);
  check_degrees(jumps.errors.empty() ? unwrapped : log, model, findings);
  if (!findings.errors.empty()) return findings;
  detail::check_motion_units(unwrapped, findings);
  if (!findings.errors.empty()) return findings;
  // First: a stuck joint ends with a jump.
  check_stuck(log, findings);
  findings.errors.insert(findings.errors.end(), jumps.errors.begin(), jumps.errors.end());
  findings.warnings.insert(findings.warnings.end(), jumps.warnings.begin(), jumps.warnings.end());
  log.position = std::move(unwrapped.position);
  if (log.torque.rows() > 0) check_saturation(log, log.torque, findings);
  check_gaps(log, max_gap, findings);
  return findings;
}

}  // namespace pcavr
