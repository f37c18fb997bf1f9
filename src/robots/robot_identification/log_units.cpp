// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/log_units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

namespace pcavr::detail {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Rows between two positions that are compared with the velocities in between: rounding and
/// noise of an encoder then count little beside the motion.
constexpr Eigen::Index kWindow = 10;
/// Correlation of recorded velocities and position differences below which a joint shows nothing:
/// it rests, or its velocities are another joint's.
constexpr double kMinCorrelation = 0.8;
/// Factor by which the velocities of all joints are off before their unit is: filters of drives and
/// stamps with jitter change speeds by some per cent.
constexpr double kOtherUnit = 1.5;
/// Relative tolerance of a factor that is a unit's.
constexpr double kUnitTolerance = 0.05;
/// [s] between rows: at longer ones no arm's motion is resolved, whatever its controller.
constexpr double kMaxInterval = 0.5;
/// [rad/s] 95th percentile of a joint's speed beyond any arm's rating.
constexpr double kFastestJoint = 30.0;

/// The relation of one joint's recorded velocities to its positions.
struct VelocityScale {
  Eigen::Index joint = 0;
  double ratio = 1.0;  ///< recorded over differentiated
};

/// Nothing where the joint does not move, or both are unrelated.
std::optional<VelocityScale> velocity_scale(const JointLog& log, Eigen::Index joint) {
  double power = 0.0, product = 0.0, recorded_power = 0.0;
  for (Eigen::Index first = 0; first + kWindow < log.position.rows(); first += kWindow) {
    const double travel = log.position(first + kWindow, joint) - log.position(first, joint);
    double recorded = 0.0;
    for (Eigen::Index i = first; i < first + kWindow; ++i) {
      const auto row = static_cast<std::size_t>(i);
      recorded += 0.5 * (log.velocity(i, joint) + log.velocity(i + 1, joint)) *
                  (log.t[row + 1] - log.t[row]);
    }
    power += travel * travel;
    product += travel * recorded;
    recorded_power += recorded * recorded;
  }
  if (!(product > kMinCorrelation * std::sqrt(power * recorded_power))) return std::nullopt;
  return VelocityScale{joint, std::sqrt(recorded_power / power)};
}

bool is_near(double ratio, double factor) {
  return std::abs(ratio / factor - 1.0) < kUnitTolerance;
}

struct TimeUnit {
  double per_second;
  const char* name;
};
constexpr auto kTimeUnits = std::to_array<TimeUnit>(
    {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}, {1.0 / 60.0, "minutes"}});

/// The unit of the stamps where velocities are `ratio` times the positions' derivatives.
std::string stamp_unit(double ratio) {
  for (const TimeUnit& unit : kTimeUnits) {
    if (is_near(ratio, unit.per_second)) return fmt::format("the stamps are {}", unit.name);
  }
  return fmt::format(
      "the stamps are not seconds (one of theirs would be {:.3g} s), or the velocities are "
      "another's, as of motors before a gear",
      1.0 / ratio);
}

Error joint_finding(const JointLog& log, const VelocityScale& scale, std::string message,
                    std::string hint) {
  return {.message = fmt::format("velocities are {:.4g} times the positions' derivatives: {}",
                                 scale.ratio, message),
          .line = log.lines.front(),
          .place = "joint " + log.joints[static_cast<std::size_t>(scale.joint)],
          .hint = std::move(hint)};
}

/// Velocities against positions over stamps: all joints with one factor have stamps, or all
/// velocities, in another unit; a single joint its own column.
void check_velocities(const JointLog& log, LogFindings& findings) {
  std::vector<VelocityScale> scales;
  std::vector<double> ratios;
  for (Eigen::Index j = 0; j < log.velocity.cols(); ++j) {
    const std::optional<VelocityScale> scale = velocity_scale(log, j);
    if (!scale) continue;
    scales.push_back(*scale);
    ratios.push_back(scale->ratio);
  }
  if (scales.empty()) return;
  const double common = median(ratios);
  const auto is_usual = [](double ratio) { return ratio < kOtherUnit && ratio * kOtherUnit > 1.0; };
  for (const VelocityScale& scale : scales) {
    if (is_usual(scale.ratio)) continue;
    if (is_near(scale.ratio * kDegree, 1.0)) {
      findings.errors.push_back(joint_finding(log, scale, "degrees", "write radians per second"));
    } else if (is_near(scale.ratio, kDegree)) {
      findings.errors.push_back(
          joint_finding(log, scale, "the positions are degrees", "write radians"));
    } else if (is_near(scale.ratio, common)) {
      findings.errors.push_back(
          joint_finding(log, scale, stamp_unit(scale.ratio), "write t in seconds"));
      findings.errors.back().place = "t";
      return;
    } else {
      findings.errors.push_back(
          joint_finding(log, scale, "another unit", "write radians and radians per second"));
    }
  }
}

double median_interval(const JointLog& log) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < log.t.size(); ++i) intervals.push_back(log.t[i] - log.t[i - 1]);
  return median(std::move(intervals));
}

/// Stamps so far apart that they are another unit's.
void check_interval(const JointLog& log, LogFindings& findings) {
  const double interval = median_interval(log);
  if (interval <= kMaxInterval) return;
  findings.errors.push_back(
      {.message = fmt::format("rows are {:.4g} s apart, which resolves no arm's motion: the stamps "
                              "are milliseconds, ticks, or another unit",
                              interval),
       .line = log.lines.front(),
       .place = "t",
       .hint = "write t in seconds"});
}

/// Speeds that no joint has: stamps that run too slowly, or positions in another unit.
void check_speeds(const JointLog& log, LogFindings& findings) {
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    std::vector<double> speeds;
    for (Eigen::Index i = kWindow; i < log.position.rows(); i += kWindow) {
      const auto row = static_cast<std::size_t>(i);
      const double dt = log.t[row] - log.t[row - static_cast<std::size_t>(kWindow)];
      speeds.push_back(std::abs(log.position(i, j) - log.position(i - kWindow, j)) / dt);
    }
    if (speeds.empty()) return;
    const auto high = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 19 / 20);
    std::nth_element(speeds.begin(), high, speeds.end());
    if (!(*high > kFastestJoint)) continue;
    findings.errors.push_back(
        {.message = fmt::format("moves at {:.3g} rad/s, beyond any arm's joint: the stamps are not "
                                "seconds, or the positions not radians",
                                *high),
         .line = log.lines.front(),
         .place = "joint " + log.joints[static_cast<std::size_t>(j)],
         .hint = "write t in seconds and positions in radians"});
    return;
  }
}

}  // namespace

void check_motion_units(const JointLog& log, LogFindings& findings) {
  if (log.velocity.rows() > 0) check_velocities(log, findings);
  if (findings.errors.empty()) check_interval(log, findings);
  if (findings.errors.empty()) check_speeds(log, findings);
}

}  // namespace pcavr::detail
