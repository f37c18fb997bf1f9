// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/input_options.hpp"

#include <array>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr auto kInputFields = std::to_array<OptionField<InputOptions>>({
    {"window", &InputOptions::window, 600.0, 5.0, 3600.0, "s",
     "recorded time that is analysed at once, and stored",
     "lower: a window has too few contacts to decide; higher: memory, and findings of a stream "
     "take longer to compute"},
    {"max_tool_speed", &InputOptions::max_tool_speed, 3.0, 0.1, 50.0, "m/s",
     "speed that the tool can't exceed",
     "lower: fast motion counts as an outlier; higher: outliers count as motion"},
    // At 500 Hz this acceleration is a millimetre off a straight line.
    {"max_tool_acceleration", &InputOptions::max_tool_acceleration, 250.0, 1.0, 1e4, "m/s^2",
     "acceleration that the tool can't exceed",
     "lower: impacts count as jumps; higher: jumps of some millimetres are missed"},
    {"max_stamp_jitter", &InputOptions::max_stamp_jitter, 2.0, 0.0, 20.0, "intervals",
     "error of the tool's stamps, in mean sample intervals",
     "lower: a driver's jitter counts as jumps; higher: jumps during fast motion are missed"},
    {"max_dropout", &InputOptions::max_dropout, 0.1, 0.0, 1.0, "s",
     "time that the tool's pose may be wrong before its new position is accepted as a jump",
     "lower: short dropouts count as motion; higher: a real jump is noticed late"},
    // Errors of poses, CAD files and the tip's radius together.
    {"max_touch_gap", &InputOptions::max_touch_gap, 0.015, 0.001, 0.1, "m",
     "distance between tip and object at which a force may act on it",
     "lower: contacts are attributed to no object where poses are inexact; higher: contacts with "
     "unknown objects are attributed to a known one"},
    {"min_gap_difference", &InputOptions::min_gap_difference, 0.003, 0.0, 0.1, "m",
     "difference of two objects' distances to the tip below which either may have been touched",
     "lower: contacts are attributed to the wrong one of two neighbours; higher: contacts near a "
     "neighbour are not used"},
    {"min_other_displacement", &InputOptions::min_other_displacement, 0.003, 0.0005, 0.1, "m",
     "displacement of another object during a contact from which on it was pushed along",
     "lower: tracking noise excludes contacts; higher: a force on two objects is used for one"},
    {"min_offset_stds", &InputOptions::min_offset_stds, 3.0, 1.0, 20.0, "stds",
     "a clock offset is applied where it exceeds this many of its standard deviations",
     "lower: noise shifts the streams; higher: small offsets remain"},
    {"min_force_offset", &InputOptions::min_force_offset, 0.0005, 0.0, 0.1, "s",
     "clock offset between tool and force below which it is not applied",
     "lower: offsets that have no effect are applied; higher: those of a sample interval remain"},
    {"min_camera_offset", &InputOptions::min_camera_offset, 0.020, 0.0, 0.5, "s",
     "clock offset between tool and tracking below which it is not applied",
     "lower: the bias of the estimate shifts the tracking; higher: offsets of a frame remain"},
});
static_assert(are_valid_fields(kInputFields));

}  // namespace

InputOptions::InputOptions() { set_defaults(*this, kInputFields); }

OptionSection section_of(InputOptions& options) {
  return make_section("inputs", options, kInputFields);
}

}  // namespace pcavr
