// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// The friction at a speed that occurred, whatever its split into Coulomb and viscous parts.
struct SlidingForce {
  double speed = 0.0;  ///< [m/s]
  double force = 0.0;  ///< [N] mu M g + B speed, and what a slow speed adds
  double std = 0.0;    ///< [N]
};

}  // namespace pcavr
