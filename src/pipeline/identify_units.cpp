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
/// As drivers and scales give it; numbers of the unit in one newton.
constexpr std::array<ForceUnit, 5> kUnits{{{"millinewtons", 1e3},
                                           {"grams-force", 1e3 / kStandardGravity},
                                           {"pounds-force", 0.22481},
                                           {"kilograms-force", 1.0 / kStandardGravity},
                                           {"kilonewtons", 1e-3}}};

/// A mass that force and motion make, against the one that somebody weighed: units are further
/// apart, and a scale or a fit is not this far off.
constexpr double kMassFactor = 3.0;
constexpr double kMassStds = 5.0;   // beyond doubt that it is another one
constexpr double kSameUnit = 1.35;  // a factor is this near to a unit's: identification is better
// Sliding friction over weight: no support resists more [rubber on glass: 2 to 4], and none but an
// air bearing less. Between are all units but those below.
constexpr double kMaxShare = 5.0;
constexpr double kMinShare = 0.003;
constexpr double kDoubtfulShare = 0.05;  // greased, on rollers or on ice; or kilograms-force
/// Pushes agree to this factor about their median, or nothing is concluded from them.
constexpr double kShareSpread = 3.0;
// Of most supports: a unit that leads here may be the one.
constexpr double kUsualMinShare = 0.08;
constexpr double kUsualMaxShare = 1.2;
/// Deeper than mesh, radius and poses leave open.
constexpr double kSurelyDeep = 0.003;    // [m]
constexpr double kSurelyPushed = 0.010;  // [m] with the tip at its surface
constexpr double kPushRange = 0.015;     // [m] of the tip to the object that it pushes
constexpr double kLookInterval = 0.02;   // [s] at which the tip is looked at

/// "is it in grams-force or millinewtons?" of the units that `fits`.
std::string guess(const auto& fits) {
  std::string names;
  for (const ForceUnit& unit : kUnits) {
    if (fits(unit.per_newton)) names += (names.empty() ? "" : " or ") + std::string(unit.name);
  }
  return names.empty() ? "write newtons, or correct the mass"
                       : "write newtons: is it in " + names + "? Or correct the mass";
}

std::string guess_by_share(double share) {
  return guess([share](double per_newton) {
    return share / per_newton > kUsualMinShare && share / per_newton < kUsualMaxShare;
  });
}

Error unit_error(std::string message, std::string hint) {
  return {.message = std::move(message), .file = "wrench.csv", .hint = std::move(hint)};
}

std::optional<Error> by_acceleration(const IdentifiableObject& object,
                                     const IdentifiedParameter& mass) {
  const double factor = mass.value / *object.mass;
  const bool is_same = factor < kMassFactor && factor > 1.0 / kMassFactor;
  if (is_same || std::abs(mass.value - *object.mass) < kMassStds * mass.deviation) {
    return std::nullopt;
  }
  char text[160];
  std::snprintf(text, sizeof text,
                " has a mass of %.3g +- %.2g kg by force and acceleration, of %.3g kg by the "
                "manifest: one of them is in another unit",
                mass.value, mass.deviation, *object.mass);
  return unit_error(object.name + text, guess([factor](double per_newton) {
                      return std::abs(std::log(factor / per_newton)) < std::log(kSameUnit);
                    }));
}

/// One object and the tip, looked at from the first to the last instant of the tool.
struct Encounter {
  double gap = std::numeric_limits<double>::infinity();  ///< [m] the smallest
  double t = 0.0;                                        ///< [s] of that
  double moved = 0.0;      ///< [m] by tracking, while the tip was near
  double max_force = 0.0;  ///< [N] horizontal, meanwhile
};

double horizontal_force(const IdentificationInput& input, double t) {
  const auto after = std::lower_bound(input.t_force.begin(), input.t_force.end(), t);
  if (after == input.t_force.end()) return 0.0;
  return input.force_base[static_cast<std::size_t>(after - input.t_force.begin())].head<2>().norm();
}

Encounter encounter_of(const IdentificationInput& input, const PathView& tip,
                       const ObjectPlaces& places, std::size_t object) {
  Encounter result;
  std::optional<Pose> before;
  for (double t = input.t_tool.front(); t < input.t_tool.back(); t += kLookInterval) {
    const auto touch = places.touch(object, t, tip.at(t), input.tool_radius);
    if (touch && touch->gap < result.gap) result.gap = touch->gap, result.t = t;
    if (!touch || touch->gap > kPushRange || !places.is_tracked(object)) {
      before.reset();
      continue;
    }
    const Pose now = places.at(object, t);
    if (!before) before = now;
    const double moved = translation_distance(*before, now);
    result.moved = std::max(result.moved, moved);
    if (moved > 0.0) result.max_force = std::max(result.max_force, horizontal_force(input, t));
  }
  return result;
}

}  // namespace

std::string doubtful_friction(std::vector<double> friction_shares) {
  const double share = median(std::move(friction_shares));
  if (share <= 0.0 || share >= kDoubtfulShare) return {};
  char text[160];
  std::snprintf(
      text, sizeof text,
      "slides under a force of %.2g of its weight, as on rollers: check that the force is "
      "in newtons and the mass in kilograms",
      share);
  return text;
}

std::optional<Error> force_unit_fault(const IdentifiableObject& object,
                                      const IdentifiedParameter& mass,
                                      std::vector<double> friction_shares) {
  if (!object.mass) return std::nullopt;
  if (mass.is_excited) return by_acceleration(object, mass);
  if (friction_shares.empty()) return std::nullopt;
  const double share = median(friction_shares);
  if (share < kMaxShare && share > kMinShare) return std::nullopt;
  const bool is_consistent =
      share > 0.0 && std::all_of(friction_shares.begin(), friction_shares.end(), [&](double one) {
        return one < kShareSpread * share && one > share / kShareSpread;
      });
  if (!is_consistent) return std::nullopt;
  char text[160];
  std::snprintf(text, sizeof text,
                " slides under a force of %.2g times its weight in %zu push%s: the force or the "
                "mass is in another unit",
                share, friction_shares.size(), friction_shares.size() == 1 ? "" : "es");
  return unit_error(object.name + text, guess_by_share(share));
}

Error no_contact_error(const IdentificationInput& input, const PathView& tip) {
  const ObjectPlaces places(input.objects);
  Encounter closest;
  std::size_t which = 0;
  char text[200];
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    const Encounter met = encounter_of(input, tip, places, i);
    if (met.gap < closest.gap) closest = met, which = i;
    if (!object.mass || met.moved < kSurelyPushed) continue;
    const double share = met.max_force / (*object.mass * kStandardGravity);
    if (share >= kMinShare) continue;
    std::snprintf(text, sizeof text,
                  " is pushed %.0f mm along by a force of at most %.2g N, %.2g of its weight: the "
                  "force or the mass is in another unit, or the sensor was off",
                  1e3 * met.moved, met.max_force, share);
    return unit_error(object.name + text, guess_by_share(share));
  }
  if (closest.gap < -kSurelyDeep) {
    std::snprintf(text, sizeof text,
                  "the force never leaves its noise, although by the poses the tip is %.1f mm "
                  "inside ",
                  -1e3 * closest.gap);
    return unit_error(text + input.objects[which].name + " at " + at_time(closest.t),
                      "check that the force is in newtons, and the poses of tool and object");
  }
  std::string message = "no contact: the force never leaves its noise";
  if (std::isfinite(closest.gap)) {
    const double gap = std::max(closest.gap, 0.0);
    std::snprintf(text, sizeof text, ", and the tip comes within %.0f mm of ", 1e3 * gap);
    message += text + input.objects[which].name + " at " + at_time(closest.t);
  }
  return unit_error(message, "press the object along z, then push it");
}

}  // namespace pcavr
