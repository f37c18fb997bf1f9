// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Eigen's factorisations, those of the sizes that are used here compiled once. To instantiate one
// takes seconds, and some sixty files use them: include this header in place of Eigen's own.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace pcavr::solvers {

template <int n>
using Square = Eigen::Matrix<double, n, n>;
template <int n>
using Column = Eigen::Matrix<double, n, 1>;
template <int n>
using Identity = typename Square<n>::IdentityReturnType;

}  // namespace pcavr::solvers

// The factorisation of a matrix of n rows, and the solutions of a column and of the identity.
#define PCAVR_CHOLESKY(KEYWORD, FACTORS, n)                                     \
  KEYWORD template Eigen::FACTORS<pcavr::solvers::Square<n>>&                   \
  Eigen::FACTORS<pcavr::solvers::Square<n>>::compute(                           \
      const Eigen::EigenBase<pcavr::solvers::Square<n>>&);                      \
  KEYWORD template void Eigen::FACTORS<pcavr::solvers::Square<n>>::_solve_impl( \
      const pcavr::solvers::Column<n>&, pcavr::solvers::Column<n>&) const;      \
  KEYWORD template void Eigen::FACTORS<pcavr::solvers::Square<n>>::_solve_impl( \
      const pcavr::solvers::Identity<n>&, pcavr::solvers::Square<n>&) const;

#define PCAVR_EIGENVALUES(KEYWORD, n)                                        \
  KEYWORD template Eigen::SelfAdjointEigenSolver<pcavr::solvers::Square<n>>& \
  Eigen::SelfAdjointEigenSolver<pcavr::solvers::Square<n>>::compute(         \
      const Eigen::EigenBase<pcavr::solvers::Square<n>>&, int);

#define PCAVR_SOLVERS(KEYWORD)                                           \
  PCAVR_CHOLESKY(KEYWORD, LDLT, 3)                                       \
  PCAVR_CHOLESKY(KEYWORD, LDLT, 5)                                       \
  PCAVR_CHOLESKY(KEYWORD, LDLT, 6)                                       \
  PCAVR_CHOLESKY(KEYWORD, LDLT, 7)                                       \
  PCAVR_CHOLESKY(KEYWORD, LDLT, Eigen::Dynamic)                          \
  PCAVR_CHOLESKY(KEYWORD, LLT, 6)                                        \
  PCAVR_EIGENVALUES(KEYWORD, 3)                                          \
  PCAVR_EIGENVALUES(KEYWORD, 4)                                          \
  PCAVR_EIGENVALUES(KEYWORD, 6)                                          \
  PCAVR_EIGENVALUES(KEYWORD, Eigen::Dynamic)                             \
  KEYWORD template class Eigen::HouseholderQR<Eigen::MatrixXd>;          \
  KEYWORD template class Eigen::PartialPivLU<pcavr::solvers::Square<6>>; \
  KEYWORD template class Eigen::JacobiSVD<Eigen::Matrix3d>;              \
  /* of Quaternion::FromTwoVectors */                                    \
  KEYWORD template class Eigen::JacobiSVD<Eigen::Matrix<double, 2, 3>>;

PCAVR_SOLVERS(extern)
