// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/square_homography.hpp"

#include <cstddef>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {

Eigen::Matrix3d square_homography(const std::array<Eigen::Vector2d, 4>& corners) {
  const double x[4] = {-1, 1, 1, -1};
  const double y[4] = {-1, -1, 1, 1};
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& c = corners[static_cast<std::size_t>(i)];
    a.row(2 * i) << x[i], y[i], 1, 0, 0, 0, -c.x() * x[i], -c.x() * y[i];
    a.row(2 * i + 1) << 0, 0, 0, x[i], y[i], 1, -c.y() * x[i], -c.y() * y[i];
    b.segment<2>(2 * i) = c;
  }
  const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
  Eigen::Matrix3d homography;
  homography << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1.0;
  return homography;
}

}  // namespace pcavr
