// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/input_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pcavr/core/gravity.hpp"

#include "teleop/body_surface.hpp"

namespace pcavr {
namespace {

// A tip this near counts as in contact: the tracking's accuracy [m].
constexpr double kContactMargin = 5e-4;
// Within this distance the force is along the direction to the body [m].
constexpr double kNear = 0.02;
// Samples of the penetration a second: enough for clocks, cheap enough for long recordings.
constexpr double kCommonRate = 200.0;
// A correlation below minus this means a reversed sign.
constexpr double kReversedCorrelation = 0.5;
// Bounds of friction over weight: support at rest (max), sliding (min).
constexpr double kMaxFriction = 10.0;
constexpr double kMinFriction = 0.01;
constexpr double kMinPushDisplacement = 0.005;  // [m] of displacement that is certainly a push
constexpr double kDensity = 700.0;              // [kg/m^3] if no mass is known
// A force may lag the penetration by this without a clock offset [s].
constexpr double kLoading = 0.015;
// Free time kept around a motion for the camera's offset, and the offset's range [s].
constexpr double kAround = 1.0;
constexpr double kRange = 0.2;
constexpr double kMinMotionSpeed = 0.1;  // [m/s] between frames: certainly in motion

/// The tip's penetration over time.
struct PenetrationSeries {
  std::vector<double> t;
  std::vector<double> penetration;           ///< [m] >= 0
  std::vector<Eigen::Vector3d> inward_base;  ///< zero if no body is near
  std::vector<std::size_t> object;           ///< the nearest
};

/// A section that is analysed at once: all of a short recording, kCalibrationTime of a long one.
struct Part {
  double begin = 0.0, end = 0.0;  ///< [s] of the tip
  std::span<const double> t_force;
  std::span<const Eigen::Vector3d> force_base;
};

std::vector<Part> parts_of(const TeleopInput& input, const TipMotion& tip) {
  const std::span<const double> stamps(input.t_force);
  const std::span<const Eigen::Vector3d> forces(input.force_base);
  std::vector<Part> parts;
  double begin = tip.t.front();
  std::size_t first = 0;
  while (tip.t.back() - begin > kCalibrationTime) {
    const double end = begin + kCalibrationTime;
    const auto next = std::lower_bound(stamps.begin(), stamps.end(), end);
    const std::size_t count = static_cast<std::size_t>(next - stamps.begin()) - first;
    parts.push_back({begin, end, stamps.subspan(first, count), forces.subspan(first, count)});
    begin = end;
    first += count;
  }
  parts.push_back({begin, tip.t.back(), stamps.subspan(first), forces.subspan(first)});
  return parts;
}

PenetrationSeries penetration_of(const TeleopInput& input, const TipMotion& tip, const Part& part) {
  PenetrationSeries series;
  std::vector<BodySurface> surfaces;
  for (const TeleopObject& object : input.objects) surfaces.emplace_back(object.model);
  const auto count = static_cast<std::size_t>((part.end - part.begin) * kCommonRate) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = part.begin + static_cast<double>(k) / kCommonRate;
    const Eigen::Vector3d p_base = tip.at(t);
    Reach nearest{.clearance = kFarAway};
    std::size_t which = 0;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const TeleopObject& object = input.objects[i];
      const Pose T_base_object =
          object.tracked.empty() ? object.T_base_object : pose_at(object.tracked, t);
      const Reach reach = surfaces[i].reach(T_base_object, p_base, input.tool_radius);
      if (reach.clearance < nearest.clearance) nearest = reach, which = i;
    }
    series.t.push_back(t);
    series.penetration.push_back(std::max(kContactMargin - nearest.clearance, 0.0));
    series.inward_base.push_back(nearest.clearance < kNear ? nearest.direction_base
                                                           : Eigen::Vector3d(0.0, 0.0, 0.0));
    series.object.push_back(which);
  }
  return series;
}

/// The smallest force at which an axis was saturated [N].
std::optional<double> force_ceiling(const std::vector<Part>& parts) {
  std::optional<double> ceiling;
  for (const Part& part : parts) {
    for (const SaturatedInterval& stretch : find_saturation(part.t_force, part.force_base)) {
      ceiling = std::min(ceiling.value_or(stretch.force), stretch.force);
    }
  }
  return ceiling;
}

/// The largest displacement of any tracked object.
double max_displacement(const TeleopInput& input) {
  double largest = 0.0;
  for (const TeleopObject& object : input.objects) {
    if (object.tracked.empty()) continue;
    const Eigen::Vector3d displacement = object.tracked.back().T_base_object.translation() -
                                         object.tracked.front().T_base_object.translation();
    largest = std::max(largest, displacement.norm());
  }
  return largest;
}

void check_unit(const TeleopInput& input, const Part& part, const PenetrationSeries& series,
                InputFindings& findings) {
  // The largest ratio of friction to weight during contact.
  double ratio = 0.0;
  std::vector<double> friction;
  for (std::size_t i = 0; i < part.force_base.size(); ++i) {
    const double index = (part.t_force[i] - series.t.front()) * kCommonRate;
    if (index < 0.0 || index >= static_cast<double>(series.t.size())) continue;
    const auto k = static_cast<std::size_t>(index);
    if (series.penetration[k] <= 0.0) continue;
    const TeleopObject& object = input.objects[series.object[k]];
    const double mass =
        object.parameters.mass ? object.parameters.mass->value : kDensity * object.model.volume;
    friction.push_back(part.force_base[i].head<2>().norm() / (mass * kStandardGravity));
  }
  if (friction.empty()) return;
  // The 99 % quantile, robust against spikes.
  const auto high =
      friction.begin() + static_cast<std::ptrdiff_t>(99 * (friction.size() - 1) / 100);
  std::nth_element(friction.begin(), high, friction.end());
  ratio = *high;
  // A mass estimated by density is an upper bound: a hollow body has a fraction of it.
  const bool have_masses =
      std::all_of(input.objects.begin(), input.objects.end(),
                  [](const TeleopObject& object) { return object.parameters.mass.has_value(); });
  const bool is_too_weak =
      have_masses && ratio < kMinFriction && max_displacement(input) > kMinPushDisplacement;
  if (ratio <= kMaxFriction && !is_too_weak) return;
  char text[160];
  std::snprintf(
      text, sizeof text,
      "the force is not used: pushes reach %.3g times the pushed object's weight; check that "
      "it is in newtons",
      ratio);
  findings.is_force_usable = false;
  findings.notes.emplace_back(text);
}

TimeOffset select_more_certain(TimeOffset rough, const std::optional<TimeOffset>& measured) {
  rough.std = std::hypot(rough.std, kLoading);
  if (!measured || !measured->is_known || measured->std >= rough.std) return rough;
  const double apart = std::abs(measured->offset - rough.offset);
  return apart < 2.0 * std::hypot(measured->std, rough.std) ? *measured : rough;
}

/// Result of the force check of one part.
enum class Verdict { undecided, usable, wrong_unit, wrong_sign };

/// Checks sign, clock and unit of the force in one part.
Verdict check_part(const TeleopInput& input, const Part& part, const PenetrationSeries& series,
                   InputFindings& findings) {
  std::vector<double> along(part.t_force.size(), 0.0);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double index = (part.t_force[i] - series.t.front()) * kCommonRate;
    if (index < 0.0 || index >= static_cast<double>(series.t.size())) continue;
    along[i] = part.force_base[i].dot(series.inward_base[static_cast<std::size_t>(index)]);
  }
  const TimeOffset offset = estimate_time_offset(series.t, series.penetration, part.t_force, along);
  if (offset.correlation < -kReversedCorrelation) {
    findings.is_force_usable = false;
    findings.notes.emplace_back(
        "the force is not used: it decreases with penetration, so its sign is reversed");
    return Verdict::wrong_sign;
  }
  if (offset.is_known) findings.tool_to_force = select_more_certain(offset, input.tool_to_force);
  check_unit(input, part, series, findings);
  if (!findings.is_force_usable) return Verdict::wrong_unit;
  return offset.is_known ? Verdict::usable : Verdict::undecided;
}

void check_force(const TeleopInput& input, const TipMotion& tip, InputFindings& findings) {
  const std::vector<Part> parts = parts_of(input, tip);
  Verdict verdict = Verdict::undecided;
  for (std::size_t i = 0; i < parts.size() && verdict == Verdict::undecided; ++i) {
    verdict = check_part(input, parts[i], penetration_of(input, tip, parts[i]), findings);
  }
  if (verdict == Verdict::wrong_sign) return;
  findings.force_ceiling = force_ceiling(parts);
  if (findings.force_ceiling) {
    char text[128];
    std::snprintf(
        text, sizeof text,
        "the force sensor saturates at %.1f N: contacts that reach it are not used to identify",
        *findings.force_ceiling);
    findings.notes.emplace_back(text);
  }
}

/// The frames of an object's longest uninterrupted motion.
struct Motion {
  std::size_t begin = 0;
  std::size_t end = 0;
  double length = 0.0;  ///< [m] of the path
};
Motion longest_motion(const std::vector<TrackedPose>& tracked) {
  Motion longest;
  Motion now;
  for (std::size_t i = 1; i < tracked.size(); ++i) {
    const double step =
        (tracked[i].T_base_object.translation() - tracked[i - 1].T_base_object.translation())
            .head<2>()
            .norm();
    const double duration = tracked[i].t - tracked[i - 1].t;
    if (step < std::min(3.0 * tracked[i].position_std, kMinMotionSpeed * duration)) {
      now = {i, i, 0.0};
      continue;
    }
    now.end = i;
    now.length += step;
    if (now.length > longest.length) longest = now;
  }
  return longest;
}

Eigen::Vector3d mean_position(const std::vector<TrackedPose>& tracked, double from, double to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const TrackedPose& pose : tracked) {
    if (pose.t < from || pose.t > to) continue;
    sum += pose.T_base_object.translation();
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count) : tracked.front().T_base_object.translation();
}

/// The pushed object moves with the tip: correlates its displacement with the tip's, which is
/// clipped to the same range.
std::optional<TimeOffset> camera_offset(const TeleopObject& object, const TipMotion& tip) {
  const std::vector<TrackedPose>& tracked = object.tracked;
  if (tracked.size() < 10) return std::nullopt;
  const Motion motion = longest_motion(tracked);
  if (motion.length < kMinPushDisplacement) return std::nullopt;
  // The slow start and end of a motion are below the noise.
  const double begin = tracked[motion.begin].t - kAround;
  const double end = tracked[motion.end].t + kAround;
  const Eigen::Vector3d from = mean_position(tracked, begin, begin + kAround - kRange);
  const Eigen::Vector3d displacement = mean_position(tracked, end - kAround + kRange, end) - from;
  if (displacement.head<2>().norm() < kMinPushDisplacement) return std::nullopt;
  const Eigen::Vector3d along =
      Eigen::Vector3d(displacement.x(), displacement.y(), 0.0).normalized();
  const double length = displacement.dot(along);
  std::vector<double> t_tip, pushed, t_seen, seen;
  std::optional<double> furthest;
  for (std::size_t i = 0; i < tip.t.size(); ++i) {
    if (tip.t[i] < begin || tip.t[i] > end) continue;
    t_tip.push_back(tip.t[i]);
    pushed.push_back(tip.p_base[i].dot(along));
    const bool is_moving = tip.t[i] > begin + kAround - kRange && tip.t[i] < end - kAround + kRange;
    if (is_moving) furthest = std::max(furthest.value_or(pushed.back()), pushed.back());
  }
  if (!furthest) return std::nullopt;
  double reached = 0.0;
  for (double& value : pushed) {
    reached = std::max(reached, std::clamp(value - (*furthest - length), 0.0, length));
    value = reached;
  }
  for (const TrackedPose& pose : tracked) {
    if (pose.t < begin || pose.t > end) continue;
    t_seen.push_back(pose.t);
    seen.push_back((pose.T_base_object.translation() - from).dot(along));
  }
  const TimeOffset offset = estimate_time_offset(t_tip, pushed, t_seen, seen, {.range = kRange});
  if (!offset.is_known || offset.correlation < 0.9) return std::nullopt;
  return offset;
}

}  // namespace

InputFindings check_input(const TeleopInput& input, const TipMotion& tip) {
  InputFindings findings;
  if (tip.t.size() < 2) {
    findings.is_force_usable = false;
    return findings;
  }
  for (const TeleopObject& object : input.objects) {
    const std::optional<TimeOffset> offset = camera_offset(object, tip);
    if (!offset) continue;
    const bool is_more_certain =
        !findings.tool_to_camera || offset->std < findings.tool_to_camera->std;
    if (is_more_certain) findings.tool_to_camera = offset;
  }
  if (input.t_force.empty()) {
    findings.is_force_usable = false;
    findings.notes.emplace_back(
        "no wrench was recorded: contact and sliding are detected by the camera alone, and "
        "nothing is identified");
    return findings;
  }
  if (!input.objects.empty()) check_force(input, tip, findings);
  return findings;
}

}  // namespace pcavr
