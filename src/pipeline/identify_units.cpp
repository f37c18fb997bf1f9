// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "pcavr/core/gravity.hpp"
#include "pcavr/core/median.hpp"

#include "identify_faults.hpp"

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

Error unit_error(std::string message, std::string hint) {
  return {.message = std::move(message), .file = "wrench.csv", .hint = std::move(hint)};
}

std::optional<Error> by_acceleration(const IdentifiableObject& object,
                                     const IdentifiedParameter& mass) {
  const double factor = mass.value / *object.mass;
  const bool is_same = factor < kMassFactor && factor > 1.0 / kMassFactor;
  if (is_same || std::abs(mass.value - *object.mass) < kMassStds * mass.std) {
    return std::nullopt;
  }
  char text[160];
  std::snprintf(text, sizeof text,
                " has a mass of %.3g +- %.2g kg by force and acceleration, of %.3g kg by the "
                "manifest: one of them is in another unit",
                mass.value, mass.std, *object.mass);
  return unit_error(object.name + text, suggest_units([factor](double per_newton) {
                      return std::abs(std::log(factor / per_newton)) < std::log(kSameUnit);
                    }));
}

/// The closest approach of the tip to one object, and the object's motion near the tip.
struct Approach {
  double gap = std::numeric_limits<double>::infinity();  ///< [m] minimum
  double t = 0.0;                                        ///< [s] of the minimum
  double moved = 0.0;      ///< [m] by tracking, while the tip was near
  double max_force = 0.0;  ///< [N] horizontal, at that time
};

double horizontal_force(const IdentificationInput& input, double t) {
  const auto after = std::lower_bound(input.t_force.begin(), input.t_force.end(), t);
  if (after == input.t_force.end()) return 0.0;
  return input.force_base[static_cast<std::size_t>(after - input.t_force.begin())].head<2>().norm();
}

Approach approach_of(const IdentificationInput& input, const PathView& tip,
                     const ObjectPoses& object_poses, std::size_t object) {
  Approach result;
  std::optional<Pose> before;
  for (double t = input.t_tool.front(); t < input.t_tool.back(); t += kSampleInterval) {
    const auto touch = object_poses.touch(object, t, tip.at(t), input.tool_radius);
    if (touch && touch->gap < result.gap) result.gap = touch->gap, result.t = t;
    if (!touch || touch->gap > kPushRange || !object_poses.is_tracked(object)) {
      before.reset();
      continue;
    }
    const Pose now = object_poses.at(object, t);
    if (!before) before = now;
    const double moved = translation_distance(*before, now);
    result.moved = std::max(result.moved, moved);
    if (moved > 0.0) result.max_force = std::max(result.max_force, horizontal_force(input, t));
  }
  return result;
}

}  // namespace

std::string doubtful_friction(std::vector<double> friction_ratios) {
  const double ratio = median(std::move(friction_ratios));
  if (ratio <= 0.0 || ratio >= kDoubtfulRatio) return {};
  char text[160];
  std::snprintf(
      text, sizeof text,
      "slides under a force of %.2g of its weight, as on rollers: check that the force is "
      "in newtons and the mass in kilograms",
      ratio);
  return text;
}

std::optional<Error> force_unit_fault(const IdentifiableObject& object,
                                      const IdentifiedParameter& mass,
                                      std::vector<double> friction_ratios) {
  if (!object.mass) return std::nullopt;
  if (mass.is_excited) return by_acceleration(object, mass);
  if (friction_ratios.empty()) return std::nullopt;
  const double ratio = median(friction_ratios);
  if (ratio < kMaxRatio && ratio > kMinRatio) return std::nullopt;
  const bool is_consistent =
      ratio > 0.0 && std::all_of(friction_ratios.begin(), friction_ratios.end(), [&](double one) {
        return one < kMaxRatioSpread * ratio && one > ratio / kMaxRatioSpread;
      });
  if (!is_consistent) return std::nullopt;
  char text[160];
  std::snprintf(text, sizeof text,
                " slides under a force of %.2g times its weight in %zu push%s: the force or the "
                "mass is in another unit",
                ratio, friction_ratios.size(), friction_ratios.size() == 1 ? "" : "es");
  return unit_error(object.name + text, suggest_units_by_ratio(ratio));
}

Error no_contact_error(const IdentificationInput& input, const PathView& tip) {
  const ObjectPoses object_poses(input.objects);
  Approach closest;
  std::size_t which = 0;
  char text[200];
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    const Approach approach = approach_of(input, tip, object_poses, i);
    if (approach.gap < closest.gap) closest = approach, which = i;
    if (!object.mass || approach.moved < kCertainDisplacement) continue;
    const double ratio = approach.max_force / (*object.mass * kStandardGravity);
    if (ratio >= kMinRatio) continue;
    std::snprintf(text, sizeof text,
                  " is pushed by %.0f mm with a force of at most %.2g N, %.2g of its weight: the "
                  "force or the mass is in another unit, or the sensor was off",
                  1e3 * approach.moved, approach.max_force, ratio);
    return unit_error(object.name + text, suggest_units_by_ratio(ratio));
  }
  if (closest.gap < -kCertainPenetration) {
    std::snprintf(text, sizeof text,
                  "the force never exceeds its noise, although by the poses the tip is %.1f mm "
                  "inside ",
                  -1e3 * closest.gap);
    return unit_error(text + input.objects[which].name + " at " + at_time(closest.t),
                      "check that the force is in newtons, and the poses of tool and object");
  }
  std::string message = "no contact: the force never exceeds its noise";
  if (std::isfinite(closest.gap)) {
    const double gap = std::max(closest.gap, 0.0);
    std::snprintf(text, sizeof text, ", and the tip comes within %.0f mm of ", 1e3 * gap);
    message += text + input.objects[which].name + " at " + at_time(closest.t);
  }
  return unit_error(message, "record a press of the object along z, then a push");
}

}  // namespace pcavr
