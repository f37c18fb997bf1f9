// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/force_fit.hpp"

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr int kFitIterations = 20;

}  // namespace

std::size_t used_count(const GravitySamples& samples) {
  return static_cast<std::size_t>(std::count_if(
      samples.begin(), samples.end(), [](const GravitySample& one) { return one.is_used; }));
}

LinearFit linear_fit(const GravitySamples& samples) {
  const double n = static_cast<double>(used_count(samples));
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), gravity = Eigen::Vector3d::Zero();
  for (const GravitySample& sample : samples) {
    if (!sample.is_used) continue;
    force += sample.force / n;
    gravity += sample.gravity_flange / n;
  }
  LinearFit fit;
  Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
  for (const GravitySample& sample : samples) {
    if (!sample.is_used) continue;
    const Eigen::Vector3d g = sample.gravity_flange - gravity;
    fit.scatter += g * g.transpose();
    mixed += g * (sample.force - force).transpose();
  }
  fit.matrix = fit.scatter.ldlt().solve(mixed).transpose();
  fit.bias = force - fit.matrix * gravity;
  for (const GravitySample& sample : samples) {
    if (!sample.is_used) continue;
    fit.squares += (sample.force - fit.bias - fit.matrix * sample.gravity_flange).squaredNorm();
  }
  return fit;
}

RigidFit start_of(const LinearFit& linear) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear.matrix,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d orthogonal = svd.matrixU() * svd.matrixV().transpose();
  RigidFit fit{.bias = linear.bias};
  fit.sign = orthogonal.determinant() < 0.0 ? -1.0 : 1.0;
  fit.R_sensor_flange = fit.sign * orthogonal;
  fit.mass = svd.singularValues().mean();
  return fit;
}

RigidFit rigid_fit(const GravitySamples& samples, RigidFit fit) {
  for (int i = 0; i < kFitIterations; ++i) {
    Matrix7d matrix = Matrix7d::Zero();
    Vector7d gradient = Vector7d::Zero();
    for (const GravitySample& sample : samples) {
      if (!sample.is_used) continue;
      Eigen::Matrix<double, 3, 7> J;
      J.leftCols<3>() = Eigen::Matrix3d::Identity();
      J.rightCols<4>() = fit.weight_slope(sample);
      matrix += J.transpose() * J;
      gradient += J.transpose() * fit.residual(sample);
    }
    const Vector7d step = matrix.ldlt().solve(gradient);
    fit.inverse = matrix.ldlt().solve(Matrix7d::Identity());
    fit.bias += step.head<3>();
    fit.mass += step[3];
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = step.tail<3>();
    fit.R_sensor_flange = fit.R_sensor_flange * Pose::exp(turn).rotation_matrix();
    if (step.norm() < 1e-12 * (1.0 + fit.mass)) break;
  }
  fit.squares = 0.0;
  fit.used = used_count(samples);
  for (const GravitySample& sample : samples) {
    if (sample.is_used) fit.squares += fit.residual(sample).squaredNorm();
  }
  return fit;
}

}  // namespace pcavr
