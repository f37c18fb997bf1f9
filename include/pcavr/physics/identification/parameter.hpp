// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

namespace pcavr {

/// One identified value and its uncertainty.
struct IdentifiedParameter {
  double value = 0.0;
  double std = 0.0;         ///< standard deviation, in the value's unit
  bool is_excited = false;  ///< false: no persistent excitation; the value means nothing
};

/// Tool and force along ONE direction on one clock: what every procedure here works on. The
/// direction is the one in which the tool pushes, so that force and progress are positive.
struct ForceMotion {
  std::span<const double> t;      ///< [s], strictly ascending
  std::span<const double> tool;   ///< [m] the tip's coordinate, growing into the object
  std::span<const double> force;  ///< [N] that the tool exerts, > 0 in contact, bias removed
  /// [m] std of `tool`. Where absent it is estimated from `tool`, as if that were not interpolated.
  std::optional<double> tool_noise = {};
};

}  // namespace pcavr
