// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/shifted_surface.hpp"

#include <array>
#include <cstddef>

namespace pcavr::detail {
namespace {

/// Index of the coefficient of u0^i u1^j u2^(4 - i - j).
constexpr std::array<std::array<std::size_t, 5>, 5> indices() {
  std::array<std::array<std::size_t, 5>, 5> result{};
  for (std::size_t k = 0; k < kQuarticExponents.size(); ++k) {
    const auto& powers = kQuarticExponents[k];
    result[static_cast<std::size_t>(powers[0])][static_cast<std::size_t>(powers[1])] = k;
  }
  return result;
}
constexpr auto kIndices = indices();

/// n! / (p! q! (n - p - q)!).
constexpr std::array<std::array<std::array<double, 5>, 5>, 5> multinomials() {
  constexpr std::array<double, 5> factorial{1.0, 1.0, 2.0, 6.0, 24.0};
  std::array<std::array<std::array<double, 5>, 5>, 5> result{};
  for (std::size_t n = 0; n < 5; ++n) {
    for (std::size_t p = 0; p <= n; ++p) {
      for (std::size_t q = 0; p + q <= n; ++q) {
        result[n][p][q] = factorial[n] / (factorial[p] * factorial[q] * factorial[n - p - q]);
      }
    }
  }
  return result;
}
constexpr auto kMultinomials = multinomials();

std::array<double, 5> powers_of(double x) noexcept {
  return {1.0, x, x * x, x * x * x, x * x * x * x};
}

}  // namespace

LimitSurface shifted(const LimitSurface& surface, const Eigen::Vector2d& centre) noexcept {
  // The moment about the centre in units of F L: u2 + a u0 + b u1, substituted and expanded.
  const std::array<double, 5> a = powers_of(centre.y() / surface.length);
  const std::array<double, 5> b = powers_of(-centre.x() / surface.length);
  LimitSurface result{surface.force, surface.length, {}};
  for (std::size_t k = 0; k < kQuarticExponents.size(); ++k) {
    if (surface.coefficients[k] == 0.0) continue;
    const auto i = static_cast<std::size_t>(kQuarticExponents[k][0]);
    const auto j = static_cast<std::size_t>(kQuarticExponents[k][1]);
    const auto n = static_cast<std::size_t>(kQuarticExponents[k][2]);
    for (std::size_t p = 0; p <= n; ++p) {
      for (std::size_t q = 0; p + q <= n; ++q) {
        result.coefficients[kIndices[i + p][j + q]] +=
            surface.coefficients[k] * kMultinomials[n][p][q] * a[p] * b[q];
      }
    }
  }
  return result;
}

}  // namespace pcavr::detail
