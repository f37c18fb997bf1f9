// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr {

/// Solves A x = b for a symmetric positive definite A, by L D L' without square roots or pivoting:
/// for the few parameters of an estimator, several times faster than the general routine.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 1> solve_positive(const Eigen::Matrix<double, N, N>& A,
                                                         const Eigen::Matrix<double, N, 1>& b) {
  Eigen::Matrix<double, N, N> L;  // unit lower; the strict lower part is used
  Eigen::Matrix<double, N, 1> pivots;
  Eigen::Matrix<double, N, 1> inverse_pivot;
  Eigen::Matrix<double, N, 1> x = b;
  for (int j = 0; j < N; ++j) {
    double pivot = A(j, j);
    for (int k = 0; k < j; ++k) pivot -= L(j, k) * L(j, k) * pivots[k];
    pivots[j] = pivot;
    inverse_pivot[j] = 1.0 / pivot;
    for (int i = j + 1; i < N; ++i) {
      double entry = A(i, j);
      for (int k = 0; k < j; ++k) entry -= L(i, k) * L(j, k) * pivots[k];
      L(i, j) = entry * inverse_pivot[j];
    }
    for (int k = 0; k < j; ++k) x[j] -= L(j, k) * x[k];
  }
  x = x.cwiseProduct(inverse_pivot).eval();
  for (int j = N - 1; j >= 0; --j) {
    for (int i = j + 1; i < N; ++i) x[j] -= L(i, j) * x[i];
  }
  return x;
}

template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> invert_positive(const Eigen::Matrix<double, N, N>& A) {
  Eigen::Matrix<double, N, N> inverse;
  for (int i = 0; i < N; ++i) {
    const Eigen::Matrix<double, N, 1> unit = Eigen::Matrix<double, N, 1>::Unit(i);
    inverse.col(i) = solve_positive<N>(A, unit);
  }
  return inverse;
}

}  // namespace pcavr
