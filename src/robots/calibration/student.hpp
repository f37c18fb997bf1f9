// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// The number of stds of Student's distribution within which 68 % lie, over those of the normal
/// one [Abramowitz & Stegun, 26.7.5].
[[nodiscard]] constexpr double student_factor(double freedoms) {
  return 1.0 + 0.5 / freedoms + 0.25 / (freedoms * freedoms);
}

}  // namespace pcavr
