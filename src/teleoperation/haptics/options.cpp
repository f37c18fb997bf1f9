// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>
#include <optional>

#include "pcavr/teleoperation/haptics/haptic_world.hpp"
#include "pcavr/teleoperation/haptics/rendered_force.hpp"
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

namespace pcavr {
namespace {

constexpr auto kForceFields = std::to_array<OptionField<ForceOptions>>({
    {"stiffness", &ForceOptions::stiffness, 1000.0, 1.0, 1e9, "N/m^n",
     "rendered stiffness of the scanned surface",
     "lower: walls feel soft; higher: the force budget limits it, and devices vibrate"},
    {"damping", &ForceOptions::damping, 0.0, 0.0, 1e9, "N s/m^(n+1)",
     "rendered damping of the scanned surface",
     "lower: contact bounces; higher: noise of the device's speed is felt"},
    {"exponent", &ForceOptions::exponent, 1.0, 1.0, 3.0, "",
     "exponent of the scanned surface's contact law",
     "lower: contact begins hard; higher: it begins soft"},
    // The force of the weakest devices.
    {"max_force", &ForceOptions::max_force, 5.0, 0.1, 1000.0, "N",
     "maximum force of the haptic device",
     "lower: walls feel soft; higher: the device saturates, and its force is not passive"},
    {"rise_time", &ForceOptions::rise_time, 0.0025, 1e-4, 1.0, "s",
     "time in which the force may rise to its maximum",
     "lower: force steps excite the device; higher: impacts feel soft"},
    // A hand on a device's handle stays under 2 g.
    {"max_acceleration", &ForceOptions::max_acceleration, 20.0, 1.0, 1000.0, "m/s^2",
     "maximum acceleration of the hand, which bounds its motion in the next cycle",
     "lower: a fast hand can gain energy; higher: forces are limited more than needed"},
    // The force is below the perception threshold.
    {"min_force", &ForceOptions::min_force, 1e-4, 1e-9, 0.1, "N",
     "force inside a surface with an empty energy budget",
     "lower: a force takes longer to build up; higher: it is perceptible, and not passive"},
});
static_assert(are_valid_fields(kForceFields));

constexpr auto kProxyFields = std::to_array<OptionField<ProxyOptions>>({
    {"radius", &ProxyOptions::radius, 0.001, 1e-5, 0.5, "m", "radius of the tool's tip",
     "lower: a scan's noise is felt; higher: details are smoothed away"},
    {"friction", &ProxyOptions::friction, 0.0, 0.0, 10.0, "",
     "friction coefficient between tip and surface",
     "lower: the tip slips; higher: it sticks to the surface"},
    {"max_motion_ratio", &ProxyOptions::max_motion_ratio, 1.0, 1.0, 100.0, "",
     "maximum displacement of the proxy in a step over that of the tip",
     "lower: the proxy lags on rough surfaces; higher: it jumps there"},
});
static_assert(are_valid_fields(kProxyFields));

constexpr auto kHapticWorldFields = std::to_array<OptionField<HapticWorldOptions>>({
    {"scan_friction", &HapticWorldOptions::scan_friction, 0.2, 0.0, 10.0, "",
     "friction coefficient between tip and scan",
     "lower: the tip slips off; higher: it sticks to the surface"},
    {"max_penetration_speed", &HapticWorldOptions::max_penetration_speed, 1.0, 0.01, 100.0, "m/s",
     "speed of the tool into a body",
     "lower: pushes begin late; higher: a jump of the hand hits the body"},
    {"catch_up_speed", &HapticWorldOptions::catch_up_speed, 0.5, 0.0, 100.0, "m/s",
     "speed by which the proxy is faster than the hand while it lags behind it in free space",
     "lower: it lags for long after rough surfaces; higher: it visibly jumps to the hand"},
    // The force of a hand.
    {"max_push_force", &HapticWorldOptions::max_push_force, 200.0, 1.0, 1e5, "N",
     "maximum force of the hand on a body",
     "lower: heavy bodies are not moved; higher: deep penetration before the tip stops"},
    // A higher force moves no further body.
    {"max_push_ratio", &HapticWorldOptions::max_push_ratio, 2.0, 1.0, 100.0, "",
     "maximum force of the hand over the static limit of all bodies together",
     "lower: rows of bodies are not moved; higher: deep penetration before the tip stops"},
    // More than the errors of a scan's plane and a body's pose together.
    {"support_height_tolerance", &HapticWorldOptions::support_height_tolerance, 0.02, 1e-4, 1.0,
     "m", "height between a support and the lowest point of a body that stands on it",
     "lower: bodies on a noisy scan never fall; higher: they stand on a shelf below them"},
    {"max_tilt", &HapticWorldOptions::max_tilt, 0.6, 0.01, 1.57, "rad",
     "tilt over an edge beyond which a body slips off it",
     "lower: it falls almost flat; higher: it turns over before it falls"},
    {"max_fall_height", &HapticWorldOptions::max_fall_height, 5.0, 0.01, 1000.0, "m",
     "height that a body falls before it stops, out of view",
     "lower: it stops in view; higher: it stays in the scene's bounds for longer"},
    // 3 % of an acceleration at 10 Hz are lost; 1 um of noise gives 0.5 m/s^2.
    {"acceleration_time", &HapticWorldOptions::acceleration_time, 0.01, 0.004, 0.06, "s",
     "time over which the tip's acceleration is found, for contacts with a mass",
     "lower: noise of the device's position is felt; higher: the mass is felt too late"},
});
static_assert(are_valid_fields(kHapticWorldFields));

}  // namespace

ForceOptions::ForceOptions() { set_defaults(*this, kForceFields); }
OptionSection section_of(ForceOptions& options) {
  OptionSection section = make_section("haptics.force", options, kForceFields);
  section.check = [&options]() -> std::optional<Error> {
    if (options.min_force <= options.max_force) return std::nullopt;
    return Error{.message = "min_force exceeds max_force"};
  };
  return section;
}

ProxyOptions::ProxyOptions() { set_defaults(*this, kProxyFields); }
OptionSection section_of(ProxyOptions& options) {
  return make_section("haptics.proxy", options, kProxyFields);
}

HapticWorldOptions::HapticWorldOptions() { set_defaults(*this, kHapticWorldFields); }
OptionSection section_of(HapticWorldOptions& options) {
  return make_section("haptics.world", options, kHapticWorldFields);
}

}  // namespace pcavr
