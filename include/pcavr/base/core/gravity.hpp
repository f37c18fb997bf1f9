// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Standard acceleration of free fall [m/s^2], by the 3rd CGPM (1901). On Earth it differs by
/// 0.3 % at most; where that matters it can be passed in.
inline constexpr double kStandardGravity = 9.80665;

}  // namespace pcavr
