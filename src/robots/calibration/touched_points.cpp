// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/touched_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "pcavr/base/core/solvers.hpp"

#include "robots/calibration/student.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinPoints = 3;
/// Points that are closer to a line than this part of their length show no turn about it.
constexpr double kMinWidthRatio = 0.05;
constexpr double kMaxScaleStds = 4.0;     ///< further from 1, lengths do not agree
constexpr double kMinScaleError = 0.005;  ///< rulers are better than this
/// Points that fit mirrored so many times better were given in a left-handed world.
constexpr double kMirrorRatio = 3.0;
constexpr double kMinMisfit = 1e-5;  ///< [m] no tip shows less

/// Points about their centre.
struct Centred {
  Eigen::Vector3d world = Eigen::Vector3d::Zero(), base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();    ///< base x world
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  ///< of the world's points
};

Centred centred(const std::vector<TouchedPoint>& points) {
  Centred sums;
  const double n = static_cast<double>(points.size());
  for (const TouchedPoint& point : points) {
    sums.world += point.p_world / n;
    sums.base += point.p_base / n;
  }
  for (const TouchedPoint& point : points) {
    const Eigen::Vector3d world = point.p_world - sums.world;
    sums.mixed += (point.p_base - sums.base) * world.transpose();
    sums.scatter += world * world.transpose();
  }
  return sums;
}

/// The rotation, or the reflection, that brings world to base.
Eigen::Matrix3d orthogonal_fit(const Eigen::Matrix3d& mixed, bool is_mirrored) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(mixed, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const double sign = (U * V.transpose()).determinant() * (is_mirrored ? -1.0 : 1.0);
  return U * Eigen::Vector3d(1.0, 1.0, sign < 0.0 ? -1.0 : 1.0).asDiagonal() * V.transpose();
}

double squares_of(const std::vector<TouchedPoint>& points, const Centred& sums,
                  const Eigen::Matrix3d& R_base_world) {
  double squares = 0.0;
  for (const TouchedPoint& point : points) {
    squares +=
        (point.p_base - sums.base - R_base_world * (point.p_world - sums.world)).squaredNorm();
  }
  return squares;
}

std::optional<Error> degenerate(const Centred& sums, std::size_t count) {
  if (count < kMinPoints) {
    return Error{.message = fmt::format("{} touched points are too few", count),
                 .hint = "touch three points and more that are not on a line"};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sums.scatter);
  const double length = std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
  const double width = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  if (length > 0.0 && width >= kMinWidthRatio * length) return std::nullopt;
  const Eigen::Vector3d axis = solver.eigenvectors().col(2);
  return Error{
      .message = fmt::format("the points lie on a line, along ({:.2f}, {:.2f}, {:.2f}) of the "
                             "world: the turn about it is not observable",
                             axis.x(), axis.y(), axis.z()),
      .hint = "touch one more point beside the line, as far as the line is long"};
}

/// The scale is compared with what remains of the residuals when it is taken out of them.
void set_scale(const Centred& sums, const Eigen::Matrix3d& R, double squares, double freedoms,
               TouchResult& result) {
  const double square = sums.scatter.trace();
  result.scale = (R.transpose() * sums.mixed).trace() / square;
  const double explained = std::pow(result.scale - 1.0, 2) * square;
  const double variance = std::max(0.0, squares - explained) / (freedoms - 1.0);
  result.scale_std = student_factor(freedoms - 1.0) * std::sqrt(variance / square);
  const double error = std::abs(result.scale - 1.0);
  if (error < kMinScaleError || error < kMaxScaleStds * result.scale_std) return;
  result.notes.push_back(fmt::format(
      "lengths in base are {:.4f} +- {:.4f} of those in the world: a unit, or a drawing "
      "of another scale",
      result.scale, result.scale_std));
}

}  // namespace

Expected<TouchResult> calibrate_touch(const std::vector<TouchedPoint>& points) {
  const Centred sums = centred(points);
  if (const auto error = degenerate(sums, points.size())) return *error;
  const Eigen::Matrix3d R = orthogonal_fit(sums.mixed, false);
  const double squares = squares_of(points, sums, R);
  const double mirrored = squares_of(points, sums, orthogonal_fit(sums.mixed, true));
  const double misfit = std::sqrt(squares / static_cast<double>(points.size()));
  if (misfit > kMinMisfit && mirrored * kMirrorRatio * kMirrorRatio < squares) {
    return Error{
        .message = fmt::format("the points fit mirrored only: within {:.2g} mm, else {:.2g} mm",
                               1e3 * std::sqrt(mirrored / static_cast<double>(points.size())),
                               1e3 * std::sqrt(squares / static_cast<double>(points.size()))),
        .hint = "the world is left-handed, or two points are exchanged"};
  }
  TouchResult result{.centre_world = sums.world};
  result.T_base_world = Pose(Eigen::Quaterniond(R), sums.base - R * sums.world);
  const double n = static_cast<double>(points.size());
  const double freedoms = 3.0 * n - 6.0;
  result.rms = std::sqrt(squares / freedoms);
  const double std = result.rms * student_factor(freedoms);
  // About the points' centre, position and rotation are independent.
  const Eigen::Matrix3d inertia = sums.scatter.trace() * Eigen::Matrix3d::Identity() - sums.scatter;
  const Eigen::Matrix3d turn = std * std * inertia.ldlt().solve(Eigen::Matrix3d::Identity());
  result.position_std = Eigen::Vector3d::Constant(std / std::sqrt(n));
  result.rotation_std = (R * turn * R.transpose()).diagonal().cwiseSqrt();
  const Eigen::Matrix3d lever = skew(sums.world);
  result.covariance.topLeftCorner<3, 3>() =
      std * std / n * Eigen::Matrix3d::Identity() + lever * turn * lever.transpose();
  result.covariance.bottomRightCorner<3, 3>() = turn;
  result.covariance.topRightCorner<3, 3>() = lever * turn;
  result.covariance.bottomLeftCorner<3, 3>() = turn * lever.transpose();
  for (const TouchedPoint& point : points) {
    result.residuals.push_back({point.name, point.p_base - result.T_base_world * point.p_world});
  }
  set_scale(sums, R, squares, freedoms, result);
  if (points.size() == kMinPoints) {
    result.notes.push_back("three points: which one is wrong, if one is, needs a fourth");
  }
  return result;
}

}  // namespace pcavr
