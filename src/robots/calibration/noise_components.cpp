// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/noise_components.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

// Variances that no sensor is below, so that a perfect input has a covariance, too.
constexpr double kPositionFloor = 1e-14;  // [m^2]
constexpr double kRotationFloor = 1e-14;  // [rad^2]
/// A source vanishes by a factor at a time; the limit keeps one that was underestimated from
/// staying at zero.
constexpr double kMinFactor = 1e-2;

/// The weight matrix of a view's residual in the restricted likelihood: W - W J C J^T W.
Matrix6d restricted_weight(const LinearView& view, const Matrix6d& weight,
                           const RigMatrix& covariance) {
  const RigJacobian weighted = weight * view.jacobian;
  return weight - weighted * covariance * weighted.transpose();
}

}  // namespace

NoiseShape noise_shape(const RigView& view, const Rig& rig, CameraMount mount) {
  const Pose T_world_camera = view.T_world_mount * rig.T_mount_camera;
  const Eigen::Vector3d p_camera_board = rig.board_scale * view.T_camera_board.translation();
  const double distance = p_camera_board.norm();
  const Eigen::Vector3d sight =
      T_world_camera.rotation() * (p_camera_board / std::max(distance, 1e-6));
  const Eigen::Vector3d p_world_board = T_world_camera * p_camera_board;
  // The arm turns about its flange: the origin of mount, or of world where the camera is beside it.
  const Eigen::Vector3d p_world_flange = mount == CameraMount::arm
                                             ? view.T_world_mount.translation()
                                             : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const double square = distance * distance;
  NoiseShape shape;
  shape.lever = -skew(p_world_board - p_world_flange);
  shape.across = square * (Eigen::Matrix3d::Identity() - sight * sight.transpose());
  shape.along = square * square * sight * sight.transpose();
  return shape;
}

Matrix6d covariance_of_source(const NoiseShape& shape, std::size_t source) {
  Matrix6d covariance = Matrix6d::Zero();
  switch (source) {
    case 0:
      covariance.topLeftCorner<3, 3>().setIdentity();
      break;
    case 1:
      covariance.topLeftCorner<3, 3>() = shape.lever * shape.lever.transpose();
      covariance.topRightCorner<3, 3>() = shape.lever;
      covariance.bottomLeftCorner<3, 3>() = shape.lever.transpose();
      covariance.bottomRightCorner<3, 3>().setIdentity();
      break;
    case 2:
      covariance.topLeftCorner<3, 3>() = shape.across;
      break;
    case 3:
      covariance.topLeftCorner<3, 3>() = shape.along;
      break;
    default:
      covariance.bottomRightCorner<3, 3>().setIdentity();
  }
  return covariance;
}

Matrix6d covariance_of(const NoiseShape& shape, const Variances& variances) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(kPositionFloor);
  covariance.diagonal().tail<3>().setConstant(kRotationFloor);
  for (std::size_t source = 0; source < kSources; ++source) {
    covariance += variances[source] * covariance_of_source(shape, source);
  }
  return covariance;
}

Variances improved(const std::vector<LinearView>& views, const RigMatrix& covariance,
                   const Variances& variances) {
  Variances explained{}, expected{};
  for (const LinearView& view : views) {
    const Matrix6d weight = covariance_of(view.shape, variances).inverse();
    const Vector6d weighted = weight * view.residual;
    const Matrix6d restricted = restricted_weight(view, weight, covariance);
    for (std::size_t source = 0; source < kSources; ++source) {
      const Matrix6d shape = covariance_of_source(view.shape, source);
      explained[source] += weighted.dot(shape * weighted);
      expected[source] += (restricted * shape).trace();
    }
  }
  Variances better = variances;
  for (std::size_t source = 0; source < kSources; ++source) {
    if (!(expected[source] > 0.0)) continue;
    better[source] *= std::max(std::sqrt(explained[source] / expected[source]), kMinFactor);
  }
  return better;
}

double deviance(const std::vector<LinearView>& views, const RigMatrix& information,
                int observable_parameters, const Variances& variances) {
  double sum = 0.0;
  for (const LinearView& view : views) {
    const Eigen::LLT<Matrix6d> factor(covariance_of(view.shape, variances));
    const Matrix6d lower = factor.matrixL();
    sum +=
        2.0 * lower.diagonal().array().log().sum() + view.residual.dot(factor.solve(view.residual));
  }
  const Eigen::SelfAdjointEigenSolver<RigMatrix> solver(information);
  for (int i = kRigParameters - observable_parameters; i < kRigParameters; ++i) {
    sum += std::log(std::max(solver.eigenvalues()[i], 1e-300));
  }
  return sum;
}

Eigen::Matrix<double, kSources, kSources> covariance_of_variances(
    const std::vector<LinearView>& views, const RigMatrix& covariance, const Variances& variances) {
  using Square = Eigen::Matrix<double, kSources, kSources>;
  Square information = Square::Zero();
  for (const LinearView& view : views) {
    const Matrix6d weight = covariance_of(view.shape, variances).inverse();
    const Matrix6d restricted = restricted_weight(view, weight, covariance);
    std::array<Matrix6d, kSources> products;
    for (std::size_t source = 0; source < kSources; ++source) {
      products[source] = restricted * covariance_of_source(view.shape, source);
    }
    for (Eigen::Index a = 0; a < information.rows(); ++a) {
      for (Eigen::Index b = 0; b < information.cols(); ++b) {
        information(a, b) +=
            0.5 *
            (products[static_cast<std::size_t>(a)] * products[static_cast<std::size_t>(b)]).trace();
      }
    }
  }
  // In relative units, since the variances differ by orders of magnitude.
  const Eigen::Matrix<double, kSources, 1> unit =
      information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Square inverse = scaled.ldlt().solve(Square::Identity());
  return unit.asDiagonal() * inverse * unit.asDiagonal();
}

}  // namespace pcavr
