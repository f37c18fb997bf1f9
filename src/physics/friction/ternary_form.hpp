// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace pcavr::detail {

/// A homogeneous polynomial of `Degree` in three variables is `coefficients . monomials(u)`.
/// Its monomials are ordered as in kQuarticExponents: by descending powers of the first variable,
/// then of the second.
template <int Degree>
struct TernaryForm {
  static constexpr int kTerms = (Degree + 1) * (Degree + 2) / 2;
  using Coefficients = Eigen::Matrix<double, kTerms, 1>;

  /// The powers of the three variables in each monomial.
  static constexpr std::array<std::array<int, 3>, kTerms> exponents() noexcept {
    std::array<std::array<int, 3>, kTerms> all{};
    std::size_t term = 0;
    for (int a = Degree; a >= 0; --a) {
      for (int b = Degree - a; b >= 0; --b) all[term++] = {a, b, Degree - a - b};
    }
    return all;
  }

  /// The coefficients of (l . u)^Degree: the multinomial theorem.
  static Coefficients power_of(const Eigen::Vector3d& l) noexcept {
    constexpr double kFactorial[] = {1.0, 1.0, 2.0, 6.0, 24.0};
    static_assert(Degree < std::ssize(kFactorial));
    const Powers powers = powers_of(l);
    Coefficients result;
    int term = 0;
    for (const auto& [a, b, c] : exponents()) {
      result[term++] = kFactorial[Degree] / (kFactorial[a] * kFactorial[b] * kFactorial[c]) *
                       powers(0, a) * powers(1, b) * powers(2, c);
    }
    return result;
  }

  /// The matrix whose product with the coefficients is the form's gradient at u, divided by Degree.
  /// By Euler's theorem that vector's product with u is the form's value.
  static Eigen::Matrix<double, 3, kTerms> gradient(const Eigen::Vector3d& u) noexcept {
    const Powers powers = powers_of(u);
    Eigen::Matrix<double, 3, kTerms> result;
    int term = 0;
    for (const std::array<int, 3>& exponent : exponents()) {
      for (int axis = 0; axis < 3; ++axis) {
        double product = exponent[static_cast<std::size_t>(axis)] / static_cast<double>(Degree);
        for (int k = 0; k < 3; ++k) {
          const int power = exponent[static_cast<std::size_t>(k)] - (k == axis ? 1 : 0);
          product *= powers(k, power < 0 ? 0 : power);
        }
        result(axis, term) = product;
      }
      ++term;
    }
    return result;
  }

 private:
  using Powers = Eigen::Matrix<double, 3, Degree + 1>;

  /// Row k: the k-th variable to the powers 0 to Degree.
  static Powers powers_of(const Eigen::Vector3d& u) noexcept {
    Powers powers;
    powers.col(0).setOnes();
    for (int n = 1; n <= Degree; ++n) powers.col(n) = powers.col(n - 1).cwiseProduct(u);
    return powers;
  }
};

}  // namespace pcavr::detail
