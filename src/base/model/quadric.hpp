// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr::model {

/// Sum of squared distances to planes, each weighted by an area [Garland & Heckbert 1997, sec. 5].
struct Quadric {
  // The symmetric matrix A, the vector b and the scalar c of p' A p + 2 b' p + c.
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0.0;
  double area = 0.0;  ///< [m^2]

  void add_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight) {
    const double d = -normal.dot(point);
    xx += weight * normal.x() * normal.x();
    xy += weight * normal.x() * normal.y();
    xz += weight * normal.x() * normal.z();
    yy += weight * normal.y() * normal.y();
    yz += weight * normal.y() * normal.z();
    zz += weight * normal.z() * normal.z();
    b += weight * d * normal;
    c += weight * d * d;
    area += weight;
  }

  Quadric& operator+=(const Quadric& other) {
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
    b += other.b;
    c += other.c;
    area += other.area;
    return *this;
  }

  /// [m^4]: squared distance times area; never below zero.
  [[nodiscard]] double error(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d ap(xx * p.x() + xy * p.y() + xz * p.z(),
                             xy * p.x() + yy * p.y() + yz * p.z(),
                             xz * p.x() + yz * p.y() + zz * p.z());
    const double value = p.dot(ap) + 2.0 * b.dot(p) + c;
    return value > 0.0 ? value : 0.0;
  }

  /// The point of minimum error, if the planes determine one; otherwise `p` is not changed.
  bool best_point(Eigen::Vector3d& p) const {
    const double m00 = yy * zz - yz * yz;
    const double m01 = xz * yz - xy * zz;
    const double m02 = xy * yz - xz * yy;
    const double determinant = xx * m00 + xy * m01 + xz * m02;
    const double trace = xx + yy + zz;
    // Ill-conditioned: planes within some 3 deg of each other do not determine the point along
    // them.
    if (determinant < 1e-5 * trace * trace * trace) return false;
    const double m11 = xx * zz - xz * xz;
    const double m12 = xy * xz - xx * yz;
    const double m22 = xx * yy - xy * xy;
    const Eigen::Vector3d r = -b / determinant;
    p = {m00 * r.x() + m01 * r.y() + m02 * r.z(), m01 * r.x() + m11 * r.y() + m12 * r.z(),
         m02 * r.x() + m12 * r.y() + m22 * r.z()};
    return true;
  }
};

}  // namespace pcavr::model
