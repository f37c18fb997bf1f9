// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/closed_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxPartners = 24;  ///< of a view: more give no better start
/// [rad] Rotations below it are noise, and rotations near a half turn have no sure axis.
constexpr double kMinAngle = 1e-4;

Eigen::Vector3d rotation_vector(const Pose& pose) { return pose.log().tail<3>(); }

/// A quaternion with w >= 0, as (x, y, z, w).
Eigen::Vector4d positive(const Eigen::Quaterniond& q) {
  return q.w() < 0.0 ? Eigen::Vector4d(-q.coeffs()) : q.coeffs();
}

/// The dual quaternion of a pose: q + eps q', with q' = (0, t) q / 2.
struct DualQuaternion {
  Eigen::Quaterniond real, dual;

  explicit DualQuaternion(const Pose& pose) : real(positive(pose.rotation())) {
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Quaterniond product = Eigen::Quaterniond(0.0, t.x(), t.y(), t.z()) * real;
    dual.coeffs() = 0.5 * product.coeffs();
  }
};

/// A pose of its dual quaternion in (w, x, y, z) order, real part then dual part.
Pose pose_of(const Eigen::Matrix<double, 8, 1>& dual) {
  const Eigen::Quaterniond q(dual[0], dual[1], dual[2], dual[3]);
  const Eigen::Quaterniond d(dual[4], dual[5], dual[6], dual[7]);
  const Eigen::Quaterniond t = d * q.conjugate();
  return Pose(q, 2.0 * t.vec());
}

/// Solves (R_mount - I) p - s R_mount_camera t_camera = -t_mount for p and s.
void solve_position(const std::vector<MotionPair>& pairs, bool with_scale,
                    const Eigen::Quaterniond& q_mount_camera, Rig& rig) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const MotionPair& pair : pairs) {
    Eigen::Matrix<double, 3, 4> rows;
    const Eigen::Vector3d turned = q_mount_camera * pair.T_camera.translation();
    rows.leftCols<3>() = pair.T_mount.rotation_matrix() - Eigen::Matrix3d::Identity();
    rows.col(3) = with_scale ? Eigen::Vector3d(-turned) : Eigen::Vector3d::Zero();
    const Eigen::Vector3d value =
        -pair.T_mount.translation() + (with_scale ? Eigen::Vector3d::Zero() : turned);
    normal += rows.transpose() * rows;
    right += rows.transpose() * value;
  }
  if (!with_scale) normal(3, 3) = 1.0;
  // Directions that the motion does not show stay at zero.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(normal);
  const double limit = 1e-9 * solver.eigenvalues()[3];
  Eigen::Vector4d solution = Eigen::Vector4d::Zero();
  for (int i = 0; i < 4; ++i) {
    if (solver.eigenvalues()[i] <= limit) continue;
    const Eigen::Vector4d direction = solver.eigenvectors().col(i);
    solution += direction.dot(right) / solver.eigenvalues()[i] * direction;
  }
  rig.T_mount_camera = Pose(q_mount_camera, solution.head<3>());
  rig.board_scale = with_scale ? solution[3] : 1.0;
}

}  // namespace

std::vector<MotionPair> motion_pairs(const std::vector<RigView>& views,
                                     const std::vector<std::size_t>& indices) {
  std::vector<MotionPair> pairs;
  const std::size_t count = indices.size();
  const std::size_t stride = 1 + (count > 1 ? (count - 2) / kMaxPartners : 0);
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; b += stride) {
      const RigView &one = views[indices[a]], &other = views[indices[b]];
      pairs.push_back({one.T_world_mount.inverse() * other.T_world_mount,
                       one.T_camera_board * other.T_camera_board.inverse()});
    }
  }
  return pairs;
}

std::optional<Rig> solve_by_park(const std::vector<MotionPair>& pairs, bool with_scale) {
  // Rotation vectors a of the mount and b of the camera: a = R b. The R that minimises the sum of
  // |a - R b|^2 is the orthogonal factor of the sum of a b^T [Park & Martin 1994, eq. 19], here by
  // singular values, which holds for motions about one axis, too.
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const MotionPair& pair : pairs) {
    sum += rotation_vector(pair.T_mount) * rotation_vector(pair.T_camera).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[0] > kMinAngle * kMinAngle)) return std::nullopt;
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d R = svd.matrixU() * sign * svd.matrixV().transpose();
  Rig rig;
  solve_position(pairs, with_scale, Eigen::Quaterniond(R), rig);
  return rig;
}

std::optional<Rig> solve_by_daniilidis(const std::vector<MotionPair>& pairs) {
  // Each motion gives six rows of T [q; q'] = 0 [Daniilidis 1999, eq. 31]:
  //   a - b         [a + b]x     0       0
  //   a' - b'       [a' + b']x   a - b   [a + b]x
  // with the vector parts a, b of the real and a', b' of the dual parts.
  Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
  for (const MotionPair& pair : pairs) {
    const DualQuaternion mount(pair.T_mount), camera(pair.T_camera);
    Eigen::Matrix<double, 6, 8> rows = Eigen::Matrix<double, 6, 8>::Zero();
    rows.block<3, 1>(0, 0) = mount.real.vec() - camera.real.vec();
    rows.block<3, 3>(0, 1) = skew(mount.real.vec() + camera.real.vec());
    rows.block<3, 1>(3, 0) = mount.dual.vec() - camera.dual.vec();
    rows.block<3, 3>(3, 1) = skew(mount.dual.vec() + camera.dual.vec());
    rows.block<3, 4>(3, 4) = rows.block<3, 4>(0, 0);
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 8, 8>> solver(normal);
  const Eigen::Matrix<double, 8, 1> one = solver.eigenvectors().col(0);
  const Eigen::Matrix<double, 8, 1> two = solver.eigenvectors().col(1);
  // The combination r one + s two whose real part is orthogonal to its dual part and has length 1
  // [eq. 34, 35].
  const Eigen::Vector4d u1 = one.head<4>(), v1 = one.tail<4>();
  const Eigen::Vector4d u2 = two.head<4>(), v2 = two.tail<4>();
  const double a = u1.dot(v1), b = u1.dot(v2) + u2.dot(v1), c = u2.dot(v2);
  std::vector<std::array<double, 2>> ratios;  // of r and s
  const double root = b * b - 4.0 * a * c;
  if (std::abs(a) > 1e-15 && root >= 0.0) {
    ratios = {{(-b + std::sqrt(root)) / (2.0 * a), 1.0}, {(-b - std::sqrt(root)) / (2.0 * a), 1.0}};
  } else {
    ratios = {{1.0, 0.0}, {0.0, 1.0}};
  }
  std::optional<Rig> best;
  double longest = 1e-6;
  for (const auto& [r, s] : ratios) {
    const Eigen::Matrix<double, 8, 1> sum = (r * one + s * two) / std::hypot(r, s);
    const double length = sum.head<4>().norm();
    if (!(length > longest)) continue;
    longest = length;
    best = Rig{.T_mount_camera = pose_of(sum / length), .T_world_board = {}};
  }
  return best;
}

void place_board(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
                 Rig& rig) {
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();  // the mean rotation is its main axis
  std::array<std::vector<double>, 3> positions;
  for (const std::size_t index : indices) {
    const Pose board = board_by_view(views[index], rig);
    scatter += board.rotation().coeffs() * board.rotation().coeffs().transpose();
    for (int axis = 0; axis < 3; ++axis) {
      positions[static_cast<std::size_t>(axis)].push_back(board.translation()[axis]);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(scatter);
  const Eigen::Vector4d mean = solver.eigenvectors().col(3);
  rig.T_world_board = Pose(Eigen::Quaterniond(mean),
                           {median(positions[0]), median(positions[1]), median(positions[2])});
}

}  // namespace pcavr
