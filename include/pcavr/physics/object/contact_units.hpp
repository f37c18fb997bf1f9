// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// The contact law of an exponent n as parameter files name it: "kelvin_voigt" for 1, F = k d +
/// b d'; "mass_damper_spring" with a mass, F = m d'' + b d' + k d; for other exponents
/// "hunt_crossley", F = k d^n + lambda d^n d'.
[[nodiscard]] std::string_view contact_law_name(double exponent, bool has_mass = false) noexcept;

/// The unit of that law's damping: "N s/m" for an exponent of 1, else "N s/m^(n+1)" with the sum in
/// decimal, such as "N s/m^2.5".
[[nodiscard]] std::string damping_unit(double exponent);

}  // namespace pcavr
