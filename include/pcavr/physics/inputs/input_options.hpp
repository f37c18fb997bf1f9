// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/identification/segmentation.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Options for examining the inputs that depend on the user's sensors and robot. Defaults, ranges
/// and meanings: src/physics/inputs/input_options.cpp.
struct InputOptions {
  InputOptions();

  double window;                  ///< [s] that is analysed at once, and stored
  double max_tool_speed;          ///< [m/s]
  double max_tool_acceleration;   ///< [m/s^2]
  double max_stamp_jitter;        ///< [sample intervals]
  double max_dropout;             ///< [s] of the tool, that is bridged
  double max_touch_gap;           ///< [m]
  double min_gap_difference;      ///< [m]
  double min_other_displacement;  ///< [m]
  double min_offset_stds;
  double min_force_offset;           ///< [s]
  double min_camera_offset;          ///< [s]
  SegmentationOptions segmentation;  ///< in its own section
};

/// "inputs" in a configuration file.
[[nodiscard]] OptionSection section_of(InputOptions& options);

}  // namespace pcavr
