// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr {

// Prior knowledge of a load, and of an arm between two runs.

inline constexpr Eigen::Index kLoad = 10;         ///< inertial parameters of the load
inline constexpr double kLoadInertiaStd = 0.3;    ///< [kg m^2]: of 3 kg at 0.3 m
inline constexpr double kChangeOfFriction = 0.1;  ///< std, relative, of warm and cold gears

}  // namespace pcavr
