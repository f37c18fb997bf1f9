// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/missing_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/solvers.hpp"

#include "perception/board/lens_slope.hpp"

namespace pcavr {
namespace {

constexpr int kGrid = 5;                    ///< places along each side of the image, for the std
constexpr double kTilt = 40.0;              ///< [deg] of a board that is still found
constexpr double kMinGain = 0.9;            ///< of the std after and before
constexpr double kNear = 0.6, kFar = 0.35;  ///< of the image's width that the board covers

/// Derivatives of the pixel of a ray by the camera's parameters, those that are estimated.
Eigen::MatrixXd pixel_jacobian(const CameraModel& camera, const Eigen::Vector2d& ray,
                               const std::vector<int>& lens) {
  const Eigen::Vector2d bent = camera.distortion.distort(ray);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2, 4 + static_cast<Eigen::Index>(lens.size()));
  jacobian(0, 0) = bent.x();
  jacobian(1, 1) = bent.y();
  jacobian(0, 2) = 1.0;
  jacobian(1, 3) = 1.0;
  for (std::size_t i = 0; i < lens.size(); ++i) {
    jacobian.col(4 + static_cast<Eigen::Index>(i)) =
        lens_slope(camera.distortion, ray, lens[i])
            .cwiseProduct(Eigen::Vector2d(camera.fx, camera.fy));
  }
  return jacobian;
}

/// The pixel's derivatives at a grid of places over the image.
std::vector<Eigen::MatrixXd> image_jacobians(const CameraModel& camera,
                                             const std::vector<int>& lens) {
  std::vector<Eigen::MatrixXd> all;
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const Eigen::Vector2d pixel((camera.width - 1.0) * column / (kGrid - 1.0),
                                  (camera.height - 1.0) * row / (kGrid - 1.0));
      all.push_back(pixel_jacobian(camera, camera.normalise(pixel), lens));
    }
  }
  return all;
}

double largest_pixel_std(const std::vector<Eigen::MatrixXd>& jacobians,
                         const Eigen::MatrixXd& covariance) {
  double largest = 0.0;
  for (const Eigen::MatrixXd& jacobian : jacobians) {
    largest = std::max(largest, (jacobian * covariance * jacobian.transpose()).trace());
  }
  return std::sqrt(largest);
}

/// Information of a view on the camera's parameters, its own pose eliminated.
Eigen::MatrixXd information_of(const CameraModel& camera, const Pose& T_camera_board,
                               const std::vector<Eigen::Vector3d>& points,
                               const std::vector<int>& lens, double noise) {
  const Eigen::Index count = 4 + static_cast<Eigen::Index>(lens.size());
  Matrix6d own = Matrix6d::Zero();
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(6, count),
                  shared = Eigen::MatrixXd::Zero(count, count);
  const Eigen::Matrix3d R = T_camera_board.rotation_matrix();
  for (const Eigen::Vector3d& p_board : points) {
    const Eigen::Vector3d p = T_camera_board * p_board;
    if (p.z() <= 0.0 || !camera.contains(camera.project(p))) continue;
    Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(2, 6);
    const Eigen::Matrix<double, 2, 3> by_point = camera.projection_jacobian(p) / noise;
    by_pose.leftCols<3>() = by_point * R;
    by_pose.rightCols<3>() = -by_point * R * skew(p_board);
    const Eigen::MatrixXd by_camera = pixel_jacobian(camera, p.head<2>() / p.z(), lens) / noise;
    own += by_pose.transpose() * by_pose;
    mixed += by_pose.transpose() * by_camera;
    shared += by_camera.transpose() * by_camera;
  }
  if (own.trace() <= 0.0) return Eigen::MatrixXd::Zero(count, count);
  own.diagonal() *= 1.0 + 1e-9;
  const Matrix6d inverse = own.ldlt().solve(Matrix6d::Identity());
  return shared - mixed.transpose() * inverse * mixed;
}

struct CandidateView {
  Pose T_camera_board;
  std::string text;
};

std::vector<CandidateView> candidates(const CameraModel& camera, const Board& board) {
  constexpr const char* kColumns[] = {"left", "middle", "right"};
  constexpr const char* kRows[] = {"upper ", "", "lower "};
  const std::vector<Eigen::Vector3d> points = board.points();
  const double size = (points.back() - points.front()).head<2>().cwiseAbs().maxCoeff();
  std::vector<CandidateView> views;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (const double part : {kNear, kFar}) {
        for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const Eigen::Vector2d pixel(camera.width * (0.3 + 0.2 * column),
                                      camera.height * (0.3 + 0.2 * row));
          const double distance = camera.fx * size / (part * camera.width);
          const double angle = kTilt * std::numbers::pi / 180.0;
          const Eigen::Matrix3d facing = Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
          const Eigen::Quaterniond turn = Eigen::AngleAxisd(angle * x, Eigen::Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(angle * y, Eigen::Vector3d::UnitY()) *
                                          Eigen::Quaterniond(facing);
          const Pose at(turn, camera.unproject(pixel, distance));
          std::string text = fmt::format(
              "the board in the {}{} of the image, over {:.0f} % of its width, {}", kRows[row],
              kColumns[column], 100.0 * part,
              x == 0 && y == 0 ? "parallel to it"
                               : fmt::format("tilted by {:.0f} degrees: its {} away", kTilt,
                                             x > 0   ? "lower edge"
                                             : x < 0 ? "upper edge"
                                             : y > 0 ? "left edge"
                                                     : "right edge"));
          views.push_back({at * Pose::from_translation(-board.centre()), std::move(text)});
        }
      }
    }
  }
  return views;
}

}  // namespace

void plan_missing_view(const BundleFit& fit, const Board& board, const BundleOptions& options,
                       CameraCalibration& result) {
  const CameraModel& camera = result.camera;
  std::vector<Eigen::Index> estimated{0, 1, 2, 3};
  for (const int i : options.lens) estimated.push_back(4 + i);
  const auto count = static_cast<Eigen::Index>(estimated.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      covariance(i, j) = result.covariance(estimated[static_cast<std::size_t>(i)],
                                           estimated[static_cast<std::size_t>(j)]);
    }
  }
  const std::vector<Eigen::MatrixXd> jacobians = image_jacobians(camera, options.lens);
  result.pixel_std = largest_pixel_std(jacobians, covariance);
  const Eigen::VectorXd unit = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd scaled =
      unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(count, count);
  const Eigen::MatrixXd now = scaled.ldlt().solve(identity);
  const std::vector<Eigen::Vector3d> points = board.points();
  std::optional<MissingView> best;
  for (CandidateView& view : candidates(camera, board)) {
    const Eigen::MatrixXd more =
        unit.asDiagonal() *
        information_of(camera, view.T_camera_board, points, options.lens, fit.noise.pixel) *
        unit.asDiagonal();
    const Eigen::MatrixXd after = unit.asDiagonal() *
                                  Eigen::MatrixXd((now + more).ldlt().solve(identity)) *
                                  unit.asDiagonal();
    const double expected = largest_pixel_std(jacobians, after);
    if (best && expected >= best->std_expected) continue;
    best = MissingView{std::move(view.text), result.pixel_std, expected};
  }
  if (best && best->std_expected < kMinGain * result.pixel_std) result.missing = std::move(best);
}

}  // namespace pcavr
