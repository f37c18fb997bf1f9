// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "quartic.hpp"

namespace pcavr::detail {

QuarticValue evaluate_quartic(const std::array<double, 15>& c, const Eigen::Vector3d& u) noexcept {
  const double xx = u.x() * u.x();
  const double xy = u.x() * u.y();
  const double xz = u.x() * u.z();
  const double yy = u.y() * u.y();
  const double yz = u.y() * u.z();
  const double zz = u.z() * u.z();
  QuarticValue q;
  // Unrolled, term by term of kQuarticExponents: this is the inner loop of every step.
  q.hessian(0, 0) =
      12 * c[0] * xx + 6 * (c[1] * xy + c[2] * xz) + 2 * (c[3] * yy + c[4] * yz + c[5] * zz);
  q.hessian(1, 1) =
      12 * c[10] * yy + 6 * (c[6] * xy + c[11] * yz) + 2 * (c[3] * xx + c[7] * xz + c[12] * zz);
  q.hessian(2, 2) =
      12 * c[14] * zz + 6 * (c[9] * xz + c[13] * yz) + 2 * (c[5] * xx + c[8] * xy + c[12] * yy);
  q.hessian(0, 1) =
      3 * (c[1] * xx + c[6] * yy) + 4 * c[3] * xy + 2 * (c[4] * xz + c[7] * yz) + c[8] * zz;
  q.hessian(0, 2) =
      3 * (c[2] * xx + c[9] * zz) + 4 * c[5] * xz + 2 * (c[4] * xy + c[8] * yz) + c[7] * yy;
  q.hessian(1, 2) =
      3 * (c[11] * yy + c[13] * zz) + 4 * c[12] * yz + 2 * (c[7] * xy + c[8] * xz) + c[4] * xx;
  q.hessian(1, 0) = q.hessian(0, 1);
  q.hessian(2, 0) = q.hessian(0, 2);
  q.hessian(2, 1) = q.hessian(1, 2);
  // Euler's theorem: a form of degree n is its gradient times its argument over n.
  q.gradient = q.hessian * u / 3.0;
  q.value = q.gradient.dot(u) / 4.0;
  return q;
}

}  // namespace pcavr::detail
