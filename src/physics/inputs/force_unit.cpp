// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/median.hpp"

#include "physics/inputs/faults.hpp"

namespace pcavr {
namespace {

struct ForceUnit {
  const char* name;
  double per_newton;
};
/// Units of drivers and scales; `per_newton` units are one newton.
constexpr std::array<ForceUnit, 5> kUnits{{{"millinewtons", 1e3},
                                           {"grams-force", 1e3 / kStandardGravity},
                                           {"pounds-force", 0.22481},
                                           {"kilograms-force", 1.0 / kStandardGravity},
                                           {"kilonewtons", 1e-3}}};

/// Ratio of the mass by force and motion to the given mass: units differ by more, and errors of a
/// scale or a fit by less.
constexpr double kMassFactor = 3.0;
constexpr double kMassStds = 5.0;   // significance of the difference
constexpr double kSameUnit = 1.35;  // tolerance to a unit's factor: identification is more accurate
// Apparent friction coefficient: no support has more [rubber on glass: 2 to 4], and only an air
// bearing has less.
constexpr double kMaxRatio = 5.0;
constexpr double kMaxRatioOfVolume = 10.0;  // where the body was not weighed
constexpr double kMinRatio = 0.003;
constexpr double kDoubtfulRatio = 0.05;  // greased, on rollers or on ice; or kilograms-force
/// Pushes must agree within this factor about their median; else they are not conclusive.
constexpr double kMaxRatioSpread = 3.0;
// Range of most supports: a unit that leads to it is a candidate.
constexpr double kUsualMinRatio = 0.08;
constexpr double kUsualMaxRatio = 1.2;
/// More than the uncertainty of mesh, radius and poses.
constexpr double kCertainPenetration = 0.003;   // [m]
constexpr double kCertainDisplacement = 0.010;  // [m] with the tip at its surface
constexpr double kPushRange = 0.015;            // [m] of the tip to the object that it pushes
constexpr double kSampleInterval = 0.02;        // [s] at which the tip's path is sampled

/// A hint that names the units for which `fits` is true.
std::string suggest_units(const auto& fits) {
  std::string names;
  for (const ForceUnit& unit : kUnits) {
    if (fits(unit.per_newton)) names += (names.empty() ? "" : " or ") + std::string(unit.name);
  }
  return names.empty() ? "write newtons, or correct the mass"
                       : "write newtons: is it in " + names + "? Or correct the mass";
}

std::string suggest_units_by_ratio(double ratio) {
  return suggest_units([ratio](double per_newton) {
    return ratio / per_newton > kUsualMinRatio && ratio / per_newton < kUsualMaxRatio;
  });
}

Error force_error(std::string message, std::string hint) {
  return {.message = std::move(message), .file = "wrench.csv", .hint = std::move(hint)};
}

InputFault unit_fault(std::string message, std::string hint) {
  return {InputFaultKind::force_unit, force_error(std::move(message), std::move(hint))};
}

double horizontal_force(const InputSeries& series, double t) {
  const auto after = std::lower_bound(series.t_force.begin(), series.t_force.end(), t);
  if (after == series.t_force.end()) return 0.0;
  return series.force_base[static_cast<std::size_t>(after - series.t_force.begin())]
      .head<2>()
      .norm();
}

Approach approach_of(const InputSeries& series, const PathView& tip, const BodyPoses& poses,
                     std::size_t object) {
  Approach result;
  std::optional<Pose> before;
  for (double t = series.t_tool.front(); t < series.t_tool.back(); t += kSampleInterval) {
    const Touch touch = poses.touch(object, t, tip.at(t), series.tool_radius);
    if (touch.gap < result.gap) result.gap = touch.gap, result.t = t;
    result.max_gap = std::max(result.max_gap, touch.gap);
    if (!(touch.gap <= kPushRange) || !poses.is_tracked(object)) {
      before.reset();
      continue;
    }
    const Pose now = poses.at(object, t);
    if (!before) before = now;
    const double moved = translation_distance(*before, now);
    result.moved = std::max(result.moved, moved);
    if (moved > 0.0) result.max_force = std::max(result.max_force, horizontal_force(series, t));
  }
  return result;
}

}  // namespace

std::string at_time(double t) { return fmt::format("t = {:.3f} s", t); }

std::string doubtful_friction(const std::string& name, const FrictionRatios& friction) {
  if (friction.ratios.empty() || !friction.is_weighed) return {};
  const double ratio = median(friction.ratios);
  if (ratio <= 0.0 || ratio >= kDoubtfulRatio) return {};
  const std::string text = fmt::format(
      " slides under a force of {:.2g} of its weight, as on rollers: check that the force is "
      "in newtons and the mass in kilograms",
      ratio);
  return name + text;
}

std::optional<InputFault> force_unit_fault(const std::string& name, double weighed_mass,
                                           const IdentifiedParameter& mass) {
  const double factor = mass.value / weighed_mass;
  const bool is_same = factor < kMassFactor && factor > 1.0 / kMassFactor;
  if (!mass.is_excited || is_same || std::abs(mass.value - weighed_mass) < kMassStds * mass.std) {
    return std::nullopt;
  }
  const std::string text = fmt::format(
      " has a mass of {:.3g} +- {:.2g} kg by force and acceleration, of {:.3g} kg by the "
      "manifest: one of them is in another unit",
      mass.value, mass.std, weighed_mass);
  return unit_fault(name + text, suggest_units([factor](double per_newton) {
                      return std::abs(std::log(factor / per_newton)) < std::log(kSameUnit);
                    }));
}

std::optional<InputFault> force_unit_fault(const std::string& name,
                                           const FrictionRatios& friction) {
  const std::vector<double>& ratios = friction.ratios;
  if (ratios.empty()) return std::nullopt;
  const double ratio = median(ratios);
  const double max = friction.is_weighed ? kMaxRatio : kMaxRatioOfVolume;
  // The mass by volume is an upper bound: a hollow body has a fraction of it.
  const double min = friction.is_weighed ? kMinRatio : 0.0;
  if (ratio < max && ratio > min) return std::nullopt;
  const bool is_consistent =
      ratio > 0.0 && std::all_of(ratios.begin(), ratios.end(), [&](double one) {
        return one < kMaxRatioSpread * ratio && one > ratio / kMaxRatioSpread;
      });
  if (!is_consistent) return std::nullopt;
  const std::string text = fmt::format(
      " slides under a force of {:.2g} times its weight in {} push{}, and any support "
      "lets it slide between {:.3g} and {:.3g}: the force or the mass is in another unit",
      ratio, ratios.size(), ratios.size() == 1 ? "" : "es", min, max);
  return unit_fault(name + text, suggest_units_by_ratio(ratio));
}

std::vector<Approach> approaches_of(const InputSeries& series, const PathView& tip,
                                    const BodyPoses& poses) {
  std::vector<Approach> approaches;
  for (std::size_t i = 0; i < series.bodies.size(); ++i) {
    approaches.push_back(approach_of(series, tip, poses, i));
  }
  return approaches;
}

NoContact explain_no_contact(const std::vector<InputBody>& bodies,
                             std::span<const Approach> approaches) {
  Approach closest;
  std::size_t which = 0;
  std::string text;
  for (std::size_t i = 0; i < approaches.size(); ++i) {
    const InputBody& body = bodies[i];
    const Approach& approach = approaches[i];
    if (approach.gap < closest.gap) closest = approach, which = i;
    if (!body.mass || approach.moved < kCertainDisplacement) continue;
    const double ratio = approach.max_force / (*body.mass * kStandardGravity);
    if (ratio >= kMinRatio) continue;
    text = fmt::format(
        " is pushed by {:.0f} mm with a force of at most {:.2g} N, {:.2g} of its weight: the "
        "force or the mass is in another unit, or the sensor was off",
        1e3 * approach.moved, approach.max_force, ratio);
    return {unit_fault(body.name + text, suggest_units_by_ratio(ratio)).error, true};
  }
  if (closest.gap <= 0.0 && closest.max_gap < kCertainPenetration) {
    return {force_error("no contact: the tip is at " + bodies[which].name +
                            " from the first sample to the last, so that the force's zero is "
                            "unknown",
                        "record free motion before the contact and after it"),
            false};
  }
  if (closest.gap < -kCertainPenetration) {
    text = fmt::format(
        "the force never exceeds its noise, although by the poses the tip is {:.1f} mm "
        "inside ",
        -1e3 * closest.gap);
    return {force_error(text + bodies[which].name + " at " + at_time(closest.t),
                        "check that the force is in newtons, and the poses of tool and object")};
  }
  std::string message = "no contact: the force never exceeds its noise";
  if (std::isfinite(closest.gap)) {
    const double gap = std::max(closest.gap, 0.0);
    text = fmt::format(", and the tip comes within {:.0f} mm of ", 1e3 * gap);
    message += text + bodies[which].name + " at " + at_time(closest.t);
  }
  return {force_error(std::move(message), "record a press of the object along z, then a push")};
}

}  // namespace pcavr
