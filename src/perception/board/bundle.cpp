// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/board/bundle.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

#include "perception/board/lens_slope.hpp"

namespace pcavr {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kHuberStds = 2.5;        ///< beyond, a point counts linearly
constexpr double kMinPixel = 1e-3;        ///< [px] no picture is more exact
constexpr double kMinArmPosition = 1e-7;  // [m]
constexpr double kMinArmRotation = 1e-7;  // [rad]
constexpr int kMaxSteps = 30;             ///< of Levenberg-Marquardt, at one noise
constexpr int kMaxNoiseRounds = 25;
constexpr double kMinNoiseChange = 1e-3;
constexpr double kMinCostChange = 1e-7;
constexpr double kMinEigenvalue = 1e-13;  ///< of a scaled matrix: less is not observable
constexpr double kBehind = 1e-3;          ///< [m] before the camera, and behind it

/// Parts of the normal equations of one view: of its own pose, of the shared parameters, mixed.
struct ViewBlock {
  Matrix6d own = Matrix6d::Zero();
  Matrix mixed, shared;  ///< 6 x m, m x m
  Vector6d own_gradient = Vector6d::Zero();
  Vector shared_gradient;
  double cost = 0.0;
};

class Bundle {
 public:
  Bundle(const std::vector<BundleView>& views, const BundleOptions& options,
         const BundleNoise& noise)
      : views_(views), options_(options), noise_(noise) {
    if (options.with_rig) {
      for (int i = 0; i < kScaleParameter; ++i) active_.push_back(i);
    }
    if (options.with_scale) active_.push_back(kScaleParameter);
    if (options.with_camera) {
      for (int i = kCameraParameter; i < kLensParameter; ++i) active_.push_back(i);
      for (const int i : options.lens) active_.push_back(kLensParameter + i);
    }
  }

  BundleFit run(const BundleModel& start) {
    BundleFit fit{.model = start};
    for (int round = 0; round < kMaxNoiseRounds; ++round) {
      descend(fit.model);
      fit.noise = noise_;
      if (!options_.with_noise) break;
      const BundleNoise before = noise_;
      update_noise(fit);
      const auto change = [](double a, double b) { return std::abs(std::log(a / b)); };
      double largest = change(noise_.pixel, before.pixel);
      if (options_.with_rig) {
        largest = std::max({largest, change(noise_.arm_position, before.arm_position),
                            change(noise_.arm_rotation, before.arm_rotation)});
      }
      if (largest < kMinNoiseChange) break;
    }
    finish(fit);
    return fit;
  }

 private:
  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(active_.size()); }

  /// Derivatives of a pixel by the camera's parameters.
  void fill_camera(const BundleModel& model, const Eigen::Vector3d& p_camera,
                   Eigen::Ref<Matrix> row) const {
    const Eigen::Vector2d normal = p_camera.head<2>() / p_camera.z();
    const CameraModel& camera = model.camera;
    const Eigen::Vector2d bent = camera.distortion.distort(normal);
    row(0, 13) = bent.x();
    row(1, 14) = bent.y();
    row(0, 15) = 1.0;
    row(1, 16) = 1.0;
    for (const int i : options_.lens) {
      row.col(kLensParameter + i) = lens_slope(camera.distortion, normal, i)
                                        .cwiseProduct(Eigen::Vector2d(camera.fx, camera.fy));
    }
  }

  /// Derivatives of p_camera by the view's twist and by the shared parameters but the camera's.
  void fill_point(const BundleModel& model, const Pose& flange, const Eigen::Vector3d& p_board,
                  Eigen::Matrix<double, 3, 6>& own, Eigen::Matrix<double, 3, 13>& shared) const {
    const Eigen::Matrix3d R_camera_mount = model.T_mount_camera.rotation_matrix().transpose();
    const Eigen::Matrix3d R_flange = flange.rotation_matrix();
    const Eigen::Vector3d p = model.board_scale * p_board;
    const Eigen::Vector3d fixed = model.T_fixed_board * p;
    const bool is_on_arm = model.mount == CameraMount::arm;
    const Eigen::Vector3d mount = is_on_arm ? flange.inverse() * fixed : flange * fixed;
    const Eigen::Vector3d p_camera = model.T_mount_camera.inverse() * mount;
    const Eigen::Matrix3d to_camera =
        R_camera_mount * (is_on_arm ? Eigen::Matrix3d(R_flange.transpose()) : R_flange);
    if (is_on_arm) {
      own.leftCols<3>() = -R_camera_mount;
      own.rightCols<3>() = R_camera_mount * skew(mount);
    } else {
      own.leftCols<3>() = to_camera;
      own.rightCols<3>() = -to_camera * skew(fixed);
    }
    const Eigen::Matrix3d R_fixed_board = model.T_fixed_board.rotation_matrix();
    shared.leftCols<3>() = -Eigen::Matrix3d::Identity();
    shared.middleCols<3>(3) = skew(p_camera);
    shared.middleCols<3>(6) = to_camera * R_fixed_board;
    shared.middleCols<3>(9) = -to_camera * R_fixed_board * skew(p);
    shared.col(12) = to_camera * R_fixed_board * p_board;
  }

  [[nodiscard]] Vector6d arm_error(std::size_t view, const BundleModel& model) const {
    return (views_[view].T_base_flange.inverse() * model.T_base_flange[view]).log();
  }

  [[nodiscard]] Vector6d arm_information() const {
    Vector6d information = Vector6d::Zero();
    if (!options_.with_rig) return information;
    information.head<3>().setConstant(1.0 / (noise_.arm_position * noise_.arm_position));
    information.tail<3>().setConstant(1.0 / (noise_.arm_rotation * noise_.arm_rotation));
    return information;
  }

  /// Huber's loss of a distance in stds, and its weight.
  static double loss(double stds) {
    return stds <= kHuberStds ? 0.5 * stds * stds : kHuberStds * (stds - 0.5 * kHuberStds);
  }

  [[nodiscard]] double cost(const BundleModel& model) const {
    double sum = 0.0;
    const Vector6d information = arm_information();
    for (std::size_t i = 0; i < views_.size(); ++i) {
      for (const double error : pixel_errors(model, views_[i], model.T_base_flange[i])) {
        sum += loss(error / noise_.pixel);
      }
      const Vector6d error = arm_error(i, model);
      sum += 0.5 * error.dot(information.cwiseProduct(error));
    }
    return sum;
  }

  [[nodiscard]] ViewBlock block_of(std::size_t index, const BundleModel& model) const {
    const BundleView& view = views_[index];
    const auto points = static_cast<Eigen::Index>(view.pixels.size());
    const Pose T_camera_board = model.T_camera_board(model.T_base_flange[index]);
    Matrix own = Matrix::Zero(2 * points, 6), shared = Matrix::Zero(2 * points, count());
    Vector residual = Vector::Zero(2 * points);
    Matrix row = Matrix::Zero(2, kSharedParameters);
    Eigen::Matrix<double, 3, 6> by_own;
    Eigen::Matrix<double, 3, 13> by_rig;
    for (Eigen::Index i = 0; i < points; ++i) {
      const Eigen::Vector3d& p_board = view.points_board[static_cast<std::size_t>(i)];
      const Eigen::Vector3d p_camera = T_camera_board * (model.board_scale * p_board);
      if (p_camera.z() < kBehind) continue;
      const Eigen::Vector2d error =
          model.camera.project(p_camera) - view.pixels[static_cast<std::size_t>(i)];
      const double stds = error.norm() / noise_.pixel;
      const double weight = std::sqrt(stds > kHuberStds ? kHuberStds / stds : 1.0) / noise_.pixel;
      const Eigen::Matrix<double, 2, 3> by_point = model.camera.projection_jacobian(p_camera);
      fill_point(model, model.T_base_flange[index], p_board, by_own, by_rig);
      row.setZero();
      row.leftCols<13>() = by_point * by_rig;
      fill_camera(model, p_camera, row);
      own.middleRows<2>(2 * i) = weight * by_point * by_own;
      for (Eigen::Index j = 0; j < count(); ++j) {
        shared.block<2, 1>(2 * i, j) = weight * row.col(active_[static_cast<std::size_t>(j)]);
      }
      residual.segment<2>(2 * i) = weight * error;
    }
    ViewBlock block;
    block.own = own.transpose() * own;
    block.mixed = own.transpose() * shared;
    block.shared = shared.transpose() * shared;
    block.own_gradient = own.transpose() * residual;
    block.shared_gradient = shared.transpose() * residual;
    const Vector6d information = arm_information();
    block.own.diagonal() += information;
    block.own_gradient += information.cwiseProduct(arm_error(index, model));
    return block;
  }

  [[nodiscard]] std::vector<ViewBlock> blocks_of(const BundleModel& model) const {
    std::vector<ViewBlock> blocks;
    for (std::size_t i = 0; i < views_.size(); ++i) blocks.push_back(block_of(i, model));
    return blocks;
  }

  /// The inverse but for directions that are not observable.
  static Matrix inverse_of(const Matrix& square) {
    if (square.rows() == 0) return square;
    const Vector unit = square.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        Matrix(unit.asDiagonal() * square * unit.asDiagonal()));
    Vector inverse = solver.eigenvalues();
    for (double& value : inverse) value = value > kMinEigenvalue ? 1.0 / value : 0.0;
    const Matrix vectors = unit.asDiagonal() * solver.eigenvectors();
    return vectors * inverse.asDiagonal() * vectors.transpose();
  }

  static Matrix6d inverse_of_own(const Matrix6d& own, double damping) {
    Matrix6d damped = own;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    return damped.ldlt().solve(Matrix6d::Identity());
  }

  [[nodiscard]] BundleModel moved(const BundleModel& model, const std::vector<Vector6d>& own,
                                  const Vector& shared) const {
    Vector step = Vector::Zero(kSharedParameters);
    for (Eigen::Index j = 0; j < count(); ++j) {
      step[active_[static_cast<std::size_t>(j)]] = shared[j];
    }
    BundleModel result = model;
    for (std::size_t i = 0; i < own.size(); ++i) {
      result.T_base_flange[i] = model.T_base_flange[i] * Pose::exp(own[i]);
    }
    result.T_mount_camera = model.T_mount_camera * Pose::exp(step.segment<6>(0));
    result.T_fixed_board = model.T_fixed_board * Pose::exp(step.segment<6>(6));
    result.board_scale += step[kScaleParameter];
    result.camera.fx += step[13];
    result.camera.fy += step[14];
    result.camera.cx += step[15];
    result.camera.cy += step[16];
    if (options_.lens.empty()) return result;
    const auto given = model.camera.distortion.coefficients();
    std::vector<double> coefficients(given.begin(), given.end());
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      coefficients[i] += step[kLensParameter + static_cast<Eigen::Index>(i)];
    }
    result.camera.distortion = LensDistortion(model.camera.distortion.model(), coefficients);
    return result;
  }

  [[nodiscard]] BundleModel stepped(const std::vector<ViewBlock>& blocks, const BundleModel& model,
                                    double damping) const {
    Matrix square = Matrix::Zero(count(), count());
    Vector right = Vector::Zero(count());
    std::vector<Matrix6d> inverses;
    for (const ViewBlock& block : blocks) {
      inverses.push_back(inverse_of_own(block.own, damping));
      square += block.shared - block.mixed.transpose() * inverses.back() * block.mixed;
      square.diagonal() += damping * block.shared.diagonal();
      right -=
          block.shared_gradient - block.mixed.transpose() * (inverses.back() * block.own_gradient);
    }
    const Vector shared = inverse_of(square) * right;
    std::vector<Vector6d> own;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      own.emplace_back(-inverses[i] * (blocks[i].own_gradient + blocks[i].mixed * shared));
    }
    return moved(model, own, shared);
  }

  void descend(BundleModel& model) const {
    double damping = 1e-3, now = cost(model);
    for (int step = 0; step < kMaxSteps; ++step) {
      const std::vector<ViewBlock> blocks = blocks_of(model);
      bool is_better = false;
      double change = 0.0;
      for (int attempt = 0; attempt < 10 && !is_better; ++attempt) {
        BundleModel next = stepped(blocks, model, damping);
        const double after = is_possible(next) ? cost(next) : now + 1.0;
        if (after <= now) {
          change = now - after;
          now = after;
          model = std::move(next);
          damping = std::max(damping * 0.1, 1e-12);
          is_better = true;
        } else {
          damping *= 10.0;
        }
      }
      if (!is_better || change <= kMinCostChange * now) return;
    }
  }

  static bool is_possible(const BundleModel& model) {
    return model.camera.fx > 0.0 && model.camera.fy > 0.0 && model.board_scale > 0.0;
  }

  /// Covariances at the optimum, and the noise that the residuals show with their freedom.
  void update_noise(BundleFit& fit) {
    const std::vector<ViewBlock> blocks = blocks_of(fit.model);
    Matrix square = Matrix::Zero(count(), count());
    std::vector<Matrix6d> inverses;
    for (const ViewBlock& block : blocks) {
      inverses.push_back(inverse_of_own(block.own, 0.0));
      square += block.shared - block.mixed.transpose() * inverses.back() * block.mixed;
    }
    const Matrix covariance = inverse_of(square);
    double points = 0.0, squares = 0.0, by_arm = 0.0;
    Eigen::Vector2d arm = Eigen::Vector2d::Zero(), tied = Eigen::Vector2d::Zero();
    const Vector6d information = arm_information();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (const double error : pixel_errors(fit.model, views_[i], fit.model.T_base_flange[i])) {
        const double stds = error / noise_.pixel;
        squares += error * error * (stds > kHuberStds ? kHuberStds / stds : 1.0);
        points += 2.0;
      }
      const Eigen::Matrix<double, 6, Eigen::Dynamic> gain = inverses[i] * blocks[i].mixed;
      const Matrix6d of_view = inverses[i] + gain * covariance * gain.transpose();
      const Vector6d error = arm_error(i, fit.model);
      arm += Eigen::Vector2d(error.head<3>().squaredNorm(), error.tail<3>().squaredNorm());
      const Vector6d part = information.cwiseProduct(of_view.diagonal());
      tied += Eigen::Vector2d(part.head<3>().sum(), part.tail<3>().sum());
    }
    const auto views = static_cast<double>(views_.size());
    by_arm = options_.with_rig ? tied.sum() : 0.0;
    const double parameters = 6.0 * views + static_cast<double>(count()) - by_arm;
    noise_.pixel = std::max(std::sqrt(squares / std::max(points - parameters, 1.0)), kMinPixel);
    if (options_.with_rig) {
      const Eigen::Vector2d freedom = (Eigen::Vector2d::Constant(3.0 * views) - tied).cwiseMax(0.3);
      fit.arm_freedom = freedom.sum();
      if (options_.with_arm_noise) {
        noise_.arm_position = std::max(std::sqrt(arm[0] / freedom[0]), kMinArmPosition);
        noise_.arm_rotation = std::max(std::sqrt(arm[1] / freedom[1]), kMinArmRotation);
      }
    }
    fit.noise = noise_;
  }

  /// Not less than the scatter of the views shows.
  static Matrix widened(const Matrix& by_noise, const Matrix& scatter) {
    const Vector ratio = scatter.diagonal().cwiseQuotient(by_noise.diagonal().cwiseMax(1e-300));
    const Vector factor = ratio.cwiseMax(1.0).cwiseSqrt();
    return factor.asDiagonal() * by_noise * factor.asDiagonal();
  }

  void finish(BundleFit& fit) const {
    const std::vector<ViewBlock> blocks = blocks_of(fit.model);
    Matrix square = Matrix::Zero(count(), count());
    std::vector<Matrix> reduced;
    std::vector<Vector> gradients;
    for (const ViewBlock& block : blocks) {
      const Matrix6d inverse = inverse_of_own(block.own, 0.0);
      reduced.emplace_back(block.shared - block.mixed.transpose() * inverse * block.mixed);
      gradients.emplace_back(block.shared_gradient -
                             block.mixed.transpose() * (inverse * block.own_gradient));
      square += reduced.back();
      Matrix6d by_pixels = block.own;
      by_pixels.diagonal() -= arm_information();
      fit.camera_board_covariance.push_back(inverse_of_own(by_pixels, 0.0));
    }
    const Matrix by_noise = inverse_of(square);
    Matrix scatter = Matrix::Zero(count(), count());
    const auto views = static_cast<double>(blocks.size());
    for (std::size_t i = 0; i < blocks.size() && blocks.size() > 2; ++i) {
      const Vector change = inverse_of(square - reduced[i]) * gradients[i];
      scatter += (views - 1.0) / views * change * change.transpose();
    }
    fit.covariance = expanded(widened(by_noise, scatter));
    double sum = 0.0, points = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      double of_view = 0.0;
      const auto errors = pixel_errors(fit.model, views_[i], fit.model.T_base_flange[i]);
      for (const double error : errors) of_view += error * error;
      sum += of_view;
      points += static_cast<double>(errors.size());
      fit.view_rms.push_back(std::sqrt(of_view / static_cast<double>(errors.size())));
    }
    fit.pixel_rms = std::sqrt(sum / points);
  }

  [[nodiscard]] Matrix expanded(const Matrix& active) const {
    Matrix all = Matrix::Zero(kSharedParameters, kSharedParameters);
    for (Eigen::Index i = 0; i < count(); ++i) {
      for (Eigen::Index j = 0; j < count(); ++j) {
        all(active_[static_cast<std::size_t>(i)], active_[static_cast<std::size_t>(j)]) =
            active(i, j);
      }
    }
    return all;
  }

  const std::vector<BundleView>& views_;
  const BundleOptions& options_;
  BundleNoise noise_;
  std::vector<int> active_;
};

}  // namespace

Pose BundleModel::T_camera_board(const Pose& T_base_flange_of_view) const {
  const Pose T_mount_fixed =
      mount == CameraMount::arm ? T_base_flange_of_view.inverse() : T_base_flange_of_view;
  return T_mount_camera.inverse() * T_mount_fixed * T_fixed_board;
}

BundleFit fit_bundle(const std::vector<BundleView>& views, const BundleModel& start,
                     const BundleNoise& noise, const BundleOptions& options) {
  return Bundle(views, options, noise).run(start);
}

std::vector<double> pixel_errors(const BundleModel& model, const BundleView& view,
                                 const Pose& T_base_flange) {
  constexpr double kHidden = 1e4;  // [px] of a point behind the camera
  const Pose T_camera_board = model.T_camera_board(T_base_flange);
  std::vector<double> errors;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector3d p = T_camera_board * (model.board_scale * view.points_board[i]);
    errors.push_back(p.z() < kBehind ? kHidden : (model.camera.project(p) - view.pixels[i]).norm());
  }
  return errors;
}

std::vector<double> board_errors(const BundleModel& model, const BundleView& view,
                                 const Pose& T_base_flange) {
  const Pose T_camera_board = model.T_camera_board(T_base_flange);
  const Eigen::Vector3d normal = T_camera_board.rotation() * Eigen::Vector3d::UnitZ();
  std::vector<double> errors;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector3d ray = model.camera.unproject(view.pixels[i], 1.0);
    const Eigen::Vector3d met = normal.dot(T_camera_board.translation()) / normal.dot(ray) * ray;
    errors.push_back((met - T_camera_board * (model.board_scale * view.points_board[i])).norm());
  }
  return errors;
}

}  // namespace pcavr
