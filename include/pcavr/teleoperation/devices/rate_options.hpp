// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Rate control: the deflection of a self-centring stick or cap is the tip's velocity.
/// Defaults and ranges of all options of this module: src/teleoperation/devices/options.cpp.
struct RateOptions {
  RateOptions();
  double max_speed;  ///< [m/s] at full deflection
  double max_lead;   ///< [m] of the tip ahead of the tool (anti-windup against walls)
  /// [rad] about base's z, from its x axis: the operator's viewing direction. Pushing
  /// forward moves the tip in that direction.
  double facing;
};
[[nodiscard]] OptionSection section_of(RateOptions& options);

}  // namespace pcavr
