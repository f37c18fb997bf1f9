// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/damping.hpp"

#include <cmath>
#include <limits>

namespace pcavr {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// (ln((1 + chi) / (1 - chi c)) - chi (1 + c)) / chi^2 by its series, for chi where the terms of
/// the closed form would cancel. Below 0.1, 20 terms leave less than one rounding error.
double residual_by_series(double chi, double c) noexcept {
  double sum = 0.0;
  double power = 1.0;      // chi^(j-2)
  double c_power = c * c;  // c^j
  double sign = -1.0;      // (-1)^(j+1)
  for (int j = 2; j < 22; ++j) {
    // Written as a product, the first term does not suffer from cancellation where c is near 1.
    const double factor = j == 2 ? -(1.0 - c) * (1.0 + c) : sign + c_power;
    sum += power * factor / j;
    power *= chi;
    c_power *= c;
    sign = -sign;
  }
  return sum;
}

/// Has the sign of ln((1 + chi) / (1 - chi c)) - chi (1 + c), for chi = (1 - exp(-w)) / c.
double residual(double w, double c) noexcept {
  const double chi = -std::expm1(-w) / c;
  if (chi < 0.1) return residual_by_series(chi, c);
  return std::log1p(chi) + w - chi * (1.0 + c);
}

}  // namespace

double exact_damping_factor(double c) noexcept {
  if (std::isnan(c)) return c;
  if (c <= 0.0) return kInfinity;
  if (c >= 1.0) return 0.0;
  // The equation is solved for w = -ln(1 - chi c), in which the root stays away from the pole at
  // chi = 1/c. There the residual has its only minimum at chi = (1 - c)/c, below the root, and it
  // is positive at w = (1 + c)/c.
  double low = -std::log(c);
  double high = (1.0 + c) / c;
  for (;;) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high) break;
    (residual(middle, c) < 0.0 ? low : high) = middle;
  }
  return -std::expm1(-high) / c;
}

std::string_view name_of(DampingLaw law) noexcept {
  switch (law) {
    case DampingLaw::flores:
      return "Flores";
    case DampingLaw::gonthier:
      return "Gonthier";
    case DampingLaw::lankarani_nikravesh:
      return "Lankarani-Nikravesh";
    case DampingLaw::lee_wang:
      return "Lee-Wang";
    case DampingLaw::hunt_crossley:
      return "Hunt-Crossley";
    case DampingLaw::zhiying_qishao:
      return "Zhiying-Qishao";
    case DampingLaw::herbert_mcwhannell:
      return "Herbert-McWhannell";
    case DampingLaw::exact:
      return "exact";
  }
  return "unknown";
}

std::string_view key_of(DampingLaw law) noexcept {
  switch (law) {
    case DampingLaw::flores:
      return "flores";
    case DampingLaw::gonthier:
      return "gonthier";
    case DampingLaw::lankarani_nikravesh:
      return "lankarani_nikravesh";
    case DampingLaw::lee_wang:
      return "lee_wang";
    case DampingLaw::hunt_crossley:
      return "hunt_crossley";
    case DampingLaw::zhiying_qishao:
      return "zhiying_qishao";
    case DampingLaw::herbert_mcwhannell:
      return "herbert_mcwhannell";
    case DampingLaw::exact:
      return "exact";
  }
  return "unknown";
}

std::optional<DampingLaw> damping_law_of(std::string_view key) noexcept {
  if (key == key_of(DampingLaw::exact)) return DampingLaw::exact;
  for (const DampingLaw law : kPublishedDampingLaws) {
    if (key == key_of(law)) return law;
  }
  return std::nullopt;
}

double damping_factor(DampingLaw law, double c) noexcept {
  if (c <= 0.0) return kInfinity;
  const double one_minus_c = 1.0 - c;
  const double one_minus_c_squared = one_minus_c * (1.0 + c);
  switch (law) {
    case DampingLaw::flores:
      return 8.0 * one_minus_c / (5.0 * c);
    case DampingLaw::gonthier:
      return one_minus_c_squared / c;
    case DampingLaw::lankarani_nikravesh:
      return 0.75 * one_minus_c_squared;
    case DampingLaw::lee_wang:
      return 0.75 * one_minus_c;
    case DampingLaw::hunt_crossley:
      return 1.5 * one_minus_c;
    case DampingLaw::zhiying_qishao:
      return 0.75 * one_minus_c_squared * std::exp(2.0 * one_minus_c);
    case DampingLaw::herbert_mcwhannell:
      return 6.0 * one_minus_c / ((2.0 * c - 1.0) * (2.0 * c - 1.0) + 3.0);
    case DampingLaw::exact:
      return exact_damping_factor(c);
  }
  return kInfinity;
}

double hunt_crossley_damping(DampingLaw law, double stiffness, double restitution,
                             double approach_speed) noexcept {
  return damping_factor(law, restitution) * stiffness / approach_speed;
}

std::optional<double> measured_restitution(const ImpactVelocities& v) noexcept {
  const double approach = v.normal.dot(v.tool_before - v.body_before);
  const double separation = v.normal.dot(v.body_after - v.tool_after);
  if (!(approach > 0.0) || !std::isfinite(approach) || !std::isfinite(separation)) {
    return std::nullopt;
  }
  return separation / approach;
}

}  // namespace pcavr
