// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/planar_pose.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

#include "perception/marker/square_homography.hpp"

namespace pcavr {
namespace {

/// The rotation about an axis in the image plane that takes the optical axis to `ray`.
Eigen::Matrix3d rotation_to(const Eigen::Vector3d& ray) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix();
}

/// Least squares on the corners' rays: linear for a given rotation.
Eigen::Vector3d solve_translation(const Eigen::Matrix3d& rotation,
                                  const std::array<Eigen::Vector2d, 4>& corners, double size) {
  Eigen::Matrix<double, 8, 3> a;
  Eigen::Matrix<double, 8, 1> b;
  const std::array<Eigen::Vector3d, 4> model = tag_corners(size);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& c = corners[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p = rotation * model[static_cast<std::size_t>(i)];
    a.row(2 * i) << 1.0, 0.0, -c.x();
    a.row(2 * i + 1) << 0.0, 1.0, -c.y();
    b(2 * i) = c.x() * p.z() - p.x();
    b(2 * i + 1) = c.y() * p.z() - p.y();
  }
  return a.colPivHouseholderQr().solve(b);
}

/// Whether the corners form a convex quadrilateral with the orientation of a tag seen from its
/// front (in our order clockwise in the image, where y points down).
bool is_seen_from_front(const std::array<Eigen::Vector2d, 4>& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (!(a.x() * b.y() - a.y() * b.x() < 0.0)) return false;
  }
  return true;
}

}  // namespace

std::vector<Pose> planar_poses(const std::array<Eigen::Vector2d, 4>& corners, double size) {
  if (!is_seen_from_front(corners)) return {};
  // The homography from the marker's plane [m], and its derivative at the tag's centre.
  Eigen::Matrix3d h = square_homography(corners);
  h.leftCols<2>() /= 0.5 * size;
  const Eigen::Vector2d centre = h.col(2).head<2>();
  const Eigen::Matrix2d jacobian = h.topLeftCorner<2, 2>() - centre * h.row(2).head<2>();

  // The derivative in a frame along the line of sight is, up to scale, two columns of a rotation.
  const Eigen::Matrix3d R_camera_sight = rotation_to(centre.homogeneous());
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1.0, 0.0, -centre.x(), 0.0, 1.0, -centre.y();
  const Eigen::Matrix2d a = (projection * R_camera_sight).leftCols<2>().inverse() * jacobian;
  const double scale = a.jacobiSvd().singularValues()(0);
  if (!(scale > 0.0) || !std::isfinite(scale)) return {};
  const Eigen::Matrix2d r = a / scale;
  const Eigen::Matrix2d remainder = Eigen::Matrix2d::Identity() - r.transpose() * r;
  Eigen::Vector2d third(std::sqrt(std::max(0.0, remainder(0, 0))),
                        std::sqrt(std::max(0.0, remainder(1, 1))));
  if (remainder(0, 1) < 0.0) third.y() = -third.y();

  std::vector<Pose> poses;
  for (const double sign : {1.0, -1.0}) {
    Eigen::Matrix3d rotation;
    rotation.topLeftCorner<2, 2>() = r;
    rotation.bottomLeftCorner<1, 2>() = sign * third.transpose();
    rotation.col(2) = rotation.col(0).cross(rotation.col(1));
    rotation = R_camera_sight * rotation;
    const Eigen::Vector3d translation = solve_translation(rotation, corners, size);
    if (!translation.allFinite() || translation.z() <= 0.0) continue;
    poses.emplace_back(Eigen::Quaterniond(rotation), translation);
  }
  return poses;
}

}  // namespace pcavr
