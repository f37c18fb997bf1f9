// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/material.hpp"

#include <cmath>
#include <numbers>

namespace pcavr {
namespace {

/// sigma of paper B, eq. 3 [1/Pa].
double compliance(const Material& material) noexcept {
  const double nu = material.poisson_ratio;
  return (1.0 - nu * nu) / (std::numbers::pi * material.youngs_modulus);
}

}  // namespace

double sphere_on_sphere(double radius_a, double radius_b) noexcept {
  return std::sqrt(radius_a / (radius_a + radius_b) * radius_b);
}

double sphere_on_plane(double radius) noexcept { return std::sqrt(radius); }

double hertz_stiffness(const Material& a, const Material& b, double tau) noexcept {
  return 4.0 * tau / (3.0 * std::numbers::pi * (compliance(a) + compliance(b)));
}

}  // namespace pcavr
