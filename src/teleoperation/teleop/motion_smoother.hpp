// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace pcavr {

/// One coordinate of a motion at a measured sample.
struct MotionSample {
  double position = 0.0;  ///< [m]
  double velocity = 0.0;  ///< [m/s]
};

/// A motion without its sensor's white noise, at each sample [Rauch, Tung & Striebel 1965]. The
/// velocity is a random walk whose strength is found about each sample by expectation maximisation
/// [Shumway & Stoffer 1982]: much is averaged where the tip is held or moves evenly, and little
/// where it stops or turns. Windows of a fixed shape round such corners, or leave noise next to
/// them. Stamps ascend strictly; `noise` [m] is the std of a sample.
[[nodiscard]] std::vector<MotionSample> smooth_motion(std::span<const double> t,
                                                      std::span<const double> position,
                                                      double noise);

/// Time by which a sample's influence on its neighbours has faded to a few per cent [s].
inline constexpr double kMotionReach = 0.8;

}  // namespace pcavr
