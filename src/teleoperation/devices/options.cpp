// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>
#include <optional>

#include "pcavr/teleoperation/devices/gamepad_device.hpp"
#include "pcavr/teleoperation/devices/plugin_device.hpp"
#include "pcavr/teleoperation/devices/rate_options.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"
#include "pcavr/teleoperation/devices/simulated_force_device.hpp"
#include "pcavr/teleoperation/devices/space_mouse_device.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "teleoperation/devices/jitter_buffer.hpp"

namespace pcavr {
namespace {

constexpr double kPi = 3.14159265358979;  // an option's range: the last digits do not matter

constexpr auto kRateFields = std::to_array<OptionField<RateOptions>>({
    // 0.15 m/s crosses a table in some seconds.
    {"max_speed", &RateOptions::max_speed, 0.15, 0.001, 10.0, "m/s",
     "speed of the tip at full deflection of a stick or cap",
     "lower: crossing the table takes long; higher: no control to a millimetre"},
    // The maximum force of 5 N is reached within it on surfaces stiffer than 250 N/m.
    {"max_lead", &RateOptions::max_lead, 0.02, 1e-4, 1.0, "m",
     "distance of the tip ahead of the tool, against a wall",
     "lower: soft surfaces never reach the maximum force; higher: the tip leaves a wall late"},
    {"facing", &RateOptions::facing, 0.0, -kPi, kPi, "rad",
     "the operator's viewing direction, about base's z, from its x axis",
     "lower, higher: pushing forward moves the tip in another direction"},
});
static_assert(are_valid_fields(kRateFields));

constexpr int kShoulderButton = 10;  // SDL_CONTROLLER_BUTTON_RIGHTSHOULDER

constexpr auto kGamepadFields = std::to_array<OptionField<GamepadOptions>>({
    // XInput's value for the left stick.
    {"dead_zone", &GamepadOptions::dead_zone, 0.24, 0.0, 0.9, "",
     "ratio of full deflection at which worn sticks rest",
     "lower: the tip drifts; higher: fine motions are not possible"},
    {"max_force", &GamepadOptions::max_force, 5.0, 0.1, 1000.0, "N",
     "force of the heavy motor's maximum amplitude",
     "lower: every contact vibrates fully; higher: weak contacts are not felt"},
    // The right face button, which the thumb reaches: SDL's order is A, B, X, Y, ...
    {"stop_button", &GamepadOptions::stop_button, 1.0, 0.0, 14.0, "",
     "SDL's number of the button that is the emergency stop; not 10, which closes the clutch",
     "lower, higher: another button"},
});
static_assert(are_valid_fields(kGamepadFields));

constexpr auto kSpaceMouseFields = std::to_array<OptionField<SpaceMouseOptions>>({
    // The value holds at the daemon's sensitivity of 1.
    {"full_deflection", &SpaceMouseOptions::full_deflection, 350.0, 1.0, 1e5, "counts",
     "counts of the cap's full deflection, at the daemon's sensitivity",
     "lower: full speed at a small deflection; higher: full speed is not reached"},
    {"stop_button", &SpaceMouseOptions::stop_button, 1.0, 1.0, 255.0, "",
     "the daemon's number of the button that is the emergency stop; 1 is the right one",
     "lower, higher: another button"},
});
static_assert(are_valid_fields(kSpaceMouseFields));

constexpr auto kRemoteFields = std::to_array<OptionField<RemoteDeviceOptions>>({
    // Hands work below 1 m/s and reach below 2; a controller that loses tracking moves at tens.
    {"max_speed", &RemoteDeviceOptions::max_speed, 2.0, 0.01, 100.0, "m/s",
     "speed limit of the tip of a page's mouse, controller or hand",
     "lower: the tip lags behind fast hands; higher: lost tracking hits bodies"},
    {"timeout", &RemoteDeviceOptions::timeout, 0.5, 0.02, 60.0, "s",
     "time without a sample after which the clutch opens (watchdog)",
     "lower: stutters of the network open it; higher: a lost page keeps on pushing"},
    // 500 Hz: pages send at a fifth of it, the fastest mice at twice.
    {"min_interval", &RemoteDeviceOptions::min_interval, 0.002, 1e-4, 0.1, "s",
     "minimum time between two samples: rate limit",
     "lower: floods of samples, and a shorter maximum delay; higher: motion is coarse"},
    // 30 Hz and half an interval of jitter.
    {"max_delay", &RemoteDeviceOptions::max_delay, 0.05, 0.002, 3.0, "s",
     "maximum playout delay, which absorbs the network's jitter; at most 31 min_interval",
     "lower: the tip stops and goes on a network with jitter; higher: no control by the delay"},
    // 10 ms behind makes the tip 20 % faster.
    {"catch_up_time", &RemoteDeviceOptions::catch_up_time, 0.05, 0.002, 10.0, "s",
     "time constant with which a tip that is late catches up",
     "lower: it jerks; higher: it stays behind the hand"},
});
static_assert(are_valid_fields(kRemoteFields));

constexpr auto kPluginFields = std::to_array<OptionField<PluginDeviceOptions>>({
    {"facing", &PluginDeviceOptions::facing, 0.0, -kPi, kPi, "rad",
     "the operator's viewing direction, about base's z, from its x axis",
     "lower, higher: pushing forward moves the tip in another direction"},
    {"max_speed", &PluginDeviceOptions::max_speed, 2.0, 0.01, 100.0, "m/s",
     "speed limit of the tip",
     "lower: it lags behind fast hands; higher: it jumps with the device"},
    // A tenth of a cycle: the rest is needed for the world.
    {"slow_limit", &PluginDeviceOptions::slow_limit, 1e-4, 1e-6, 0.1, "s",
     "duration of an exchange from which it counts as slow",
     "lower: every exchange counts; higher: exchanges that delay the cycle are not counted"},
});
static_assert(are_valid_fields(kPluginFields));

constexpr auto kTraceFields = std::to_array<OptionField<TraceDeviceOptions>>({
    {"max_speed", &TraceDeviceOptions::max_speed, 2.0, 0.01, 100.0, "m/s", "speed limit of the tip",
     "lower: it lags behind the trace; higher: jumps of the trace remain"},
});
static_assert(are_valid_fields(kTraceFields));

constexpr auto kSimulatedFields = std::to_array<OptionField<SimulatedForceDeviceOptions>>({
    {"sway", &SimulatedForceDeviceOptions::sway, 0.05, 0.0, 1.0, "m",
     "amplitude of the hand's motion to either side, and downwards",
     "lower: it touches nothing; higher: it leaves the table"},
    {"sway_period", &SimulatedForceDeviceOptions::sway_period, 4.0, 0.1, 1000.0, "s",
     "period of the hand's motion", "lower: faster than a hand; higher: contacts are rare"},
    // A relaxed grip has some hundreds.
    {"hand_stiffness", &SimulatedForceDeviceOptions::hand_stiffness, 400.0, 1.0, 1e5, "N/m",
     "stiffness of the hand", "lower: forces push it away; higher: stiffer than any grip"},
    // The hand is slightly underdamped with this mass and stiffness.
    {"hand_damping", &SimulatedForceDeviceOptions::hand_damping, 10.0, 0.0, 1e4, "N s/m",
     "damping of the hand", "lower: it oscillates; higher: it follows its target late"},
    // The apparent mass of a desktop device.
    {"mass", &SimulatedForceDeviceOptions::mass, 0.2, 0.001, 100.0, "kg", "mass of hand and handle",
     "lower: forces accelerate it away; higher: it is sluggish"},
    {"friction", &SimulatedForceDeviceOptions::friction, 0.5, 0.0, 1e4, "N s/m",
     "viscous friction in the device's joints",
     "lower: less passive than real devices; higher: it hides active rendering"},
    {"force_noise", &SimulatedForceDeviceOptions::force_noise, 0.02, 0.0, 100.0, "N",
     "std of the motors' force, each cycle and axis",
     "lower: better than real motors; higher: noise hides contacts"},
    {"max_force", &SimulatedForceDeviceOptions::max_force, 5.0, 0.1, 1000.0, "N",
     "saturation of the motors", "lower: walls feel soft; higher: stronger than desktop devices"},
});
static_assert(are_valid_fields(kSimulatedFields));

}  // namespace

RateOptions::RateOptions() { set_defaults(*this, kRateFields); }
OptionSection section_of(RateOptions& options) {
  return make_section("devices.rate", options, kRateFields);
}

GamepadOptions::GamepadOptions() { set_defaults(*this, kGamepadFields); }
OptionSection section_of(GamepadOptions& options) {
  OptionSection section = make_section("devices.gamepad", options, kGamepadFields);
  section.check = [&options]() -> std::optional<Error> {
    if (options.stop_button != kShoulderButton) return std::nullopt;
    return Error{.message = "stop_button is the right shoulder button, which closes the clutch",
                 .hint = "use another button: 1 is the right face button"};
  };
  return section;
}

SpaceMouseOptions::SpaceMouseOptions() { set_defaults(*this, kSpaceMouseFields); }
OptionSection section_of(SpaceMouseOptions& options) {
  return make_section("devices.spacemouse", options, kSpaceMouseFields);
}

RemoteDeviceOptions::RemoteDeviceOptions() : name("remote") { set_defaults(*this, kRemoteFields); }
OptionSection section_of(RemoteDeviceOptions& options) {
  OptionSection section = make_section("devices.page", options, kRemoteFields);
  section.check = [&options]() -> std::optional<Error> {
    if (JitterBuffer::covers(options.max_delay, options.min_interval)) return std::nullopt;
    return Error{.message = "max_delay exceeds 31 min_interval",
                 .hint = "increase min_interval: a page sends every 11 to 17 ms"};
  };
  return section;
}

PluginDeviceOptions::PluginDeviceOptions() { set_defaults(*this, kPluginFields); }
OptionSection section_of(PluginDeviceOptions& options) {
  return make_section("devices.plugin", options, kPluginFields);
}

TraceDeviceOptions::TraceDeviceOptions() { set_defaults(*this, kTraceFields); }
OptionSection section_of(TraceDeviceOptions& options) {
  return make_section("devices.trace", options, kTraceFields);
}

SimulatedForceDeviceOptions::SimulatedForceDeviceOptions() : seed(1) {
  set_defaults(*this, kSimulatedFields);
}
OptionSection section_of(SimulatedForceDeviceOptions& options) {
  return make_section("devices.simulated", options, kSimulatedFields);
}

}  // namespace pcavr
