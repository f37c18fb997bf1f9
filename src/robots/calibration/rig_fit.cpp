// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/rig_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "robots/calibration/closed_form.hpp"
#include "robots/calibration/refine_rig.hpp"

namespace pcavr {
namespace {

// Subsets for a start: with a fifth of the views wrong, all but 1e-16 of the draws of 80 sets have
// a sound one.
constexpr int kSubsets = 80;
constexpr std::size_t kSubsetSize = 4;  ///< views, the fewest with spread axes in nearly all draws
constexpr std::uint64_t kSubsetSeed = 1;
constexpr double kBoardSize = 0.15;  ///< [m] std of the best point's distance from the origin
constexpr double kScoreLever = 0.3;  ///< [m] by which rotations count in a start's score

constexpr int kMaxIterations = 120;
constexpr int kGateInterval = 10;    ///< iterations between two looks for outliers
constexpr int kVarianceSteps = 3;    ///< of an iteration
constexpr double kMinChange = 1e-4;  ///< [1] of the variances: their own noise is 1e-1
/// Views further than this many robust stds of six coordinates are no part of the first fit.
constexpr double kFirstLimit = 60.0;
constexpr double kMinUnit = 1e-7;         ///< [m] and [rad] of a perfect input
constexpr double kMedianOfThree = 1.538;  ///< of a normal vector's norm in three dimensions

/// 99.99 % of chi^2 with six degrees of freedom, and how much that grows with few residuals, as
/// Fisher's distribution does.
constexpr double kOutlierLimit = 28.0;
constexpr double kFewResiduals = 18.0;
constexpr std::size_t kMinGated = 6;  ///< views: fewer can't show which one is wrong

/// Rotations about a second axis show it where they are this many times the rotations' noise.
constexpr double kMinSpread = 3.0;
constexpr double kMinSpreadAngle = 1e-4;  ///< [rad] of inputs without noise

double score(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
             const Rig& rig) {
  std::vector<double> errors;
  for (const std::size_t index : indices) {
    const Vector6d residual = residual_of(views[index], rig);
    errors.push_back(residual.head<3>().norm() + kScoreLever * residual.tail<3>().norm());
  }
  return median(std::move(errors));
}

/// Different indices, drawn from `indices`.
std::vector<std::size_t> draw(std::vector<std::size_t> indices, std::size_t count, Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(indices[i], indices[i + random.below(indices.size() - i)]);
  }
  indices.resize(count);
  return indices;
}

/// Sources of about equal shares, for a start.
Variances first_variances(const std::vector<RigView>& views,
                          const std::vector<std::size_t>& indices, const Rig& rig,
                          const TypicalResidual& typical, CameraMount mount) {
  std::vector<double> levers, distances;
  for (const std::size_t index : indices) {
    levers.push_back(noise_shape(views[index], rig, mount).lever.norm() / std::sqrt(2.0));
    distances.push_back(views[index].T_camera_board.translation().norm());
  }
  const double lever = std::max(median(levers), 1e-3);
  const double distance = std::max(rig.board_scale * median(distances), 1e-3);
  const double position = typical.position * typical.position / 4.0;
  const double rotation = typical.rotation * typical.rotation / 2.0;
  return {position, std::min(rotation, position / (lever * lever)),
          position / (distance * distance), position / std::pow(distance, 4), rotation};
}

/// A Gauss-Newton step of the rig at these variances; keeps information and covariance in `fit`.
RigVector solve_step(const std::vector<LinearView>& linear, const Eigen::MatrixXd& basis,
                     RigFit& fit) {
  fit.information = RigMatrix::Zero(kRigParameters, kRigParameters);
  RigVector gradient = RigVector::Zero(kRigParameters);
  for (const LinearView& view : linear) {
    const RigJacobian weighted = covariance_of(view.shape, fit.variances).inverse() * view.jacobian;
    fit.information += weighted.transpose() * view.jacobian;
    gradient += weighted.transpose() * view.residual;
  }
  const Eigen::MatrixXd reduced = basis.transpose() * fit.information * basis;
  const Eigen::MatrixXd inverse =
      reduced.ldlt().solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));
  fit.information = basis * reduced * basis.transpose();
  fit.covariance = basis * inverse * basis.transpose();
  fit.observable_parameters = static_cast<int>(basis.cols());
  return -fit.covariance * gradient;
}

/// Whether the rotations are about one axis but for their noise.
std::optional<Eigen::Vector3d> unobservable_axis(const std::vector<RigView>& views,
                                                 const RigFit& fit) {
  const RotationSpread spread = rotation_spread(views, fit.used);
  const double noise = typical_residual(views, fit.used, fit.rig).rotation;
  if (spread.second > std::max(kMinSpread * noise, kMinSpreadAngle)) return std::nullopt;
  return spread.axis_mount;
}

/// Rig and variances, in turns, with the views as they are; true where they have settled.
bool iterate(const std::vector<RigView>& views, const RigFitOptions& options, int iterations,
             RigFit& fit) {
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const std::vector<LinearView> linear = linearised(views, fit.used, fit.rig, options.mount);
    const RigVector step = solve_step(linear, estimated_basis(fit, views, options), fit);
    fit.rig = moved(fit.rig, step);
    std::vector<LinearView> at = linearised(views, fit.used, fit.rig, options.mount);
    const Variances before = fit.variances;
    for (int i = 0; i < kVarianceSteps; ++i) {
      fit.variances = improved(at, fit.covariance, fit.variances);
    }
    const double change = variance_change(at.front().shape, before, fit.variances);
    if (change < kMinChange && step.norm() < 1e-9 + 1e-4 * std::sqrt(fit.covariance.trace())) {
      return true;
    }
  }
  return false;
}

/// The views of `indices` that the fit explains.
std::vector<std::size_t> explained_views(const std::vector<RigView>& views,
                                         const std::vector<std::size_t>& indices, const RigFit& fit,
                                         CameraMount mount) {
  if (indices.size() < kMinGated) return indices;
  const std::vector<LinearView> linear = linearised(views, indices, fit.rig, mount);
  std::vector<std::size_t> explained;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const bool is_used = std::binary_search(fit.used.begin(), fit.used.end(), indices[i]);
    if (squared_distance(linear[i], fit, is_used) < outlier_limit(fit.used.size())) {
      explained.push_back(indices[i]);
    }
  }
  return 2 * explained.size() < indices.size() ? fit.used : explained;
}

}  // namespace

Eigen::MatrixXd estimated_basis(const RigFit& fit, const std::vector<RigView>& views,
                                const RigFitOptions& options) {
  std::vector<RigVector> fixed;
  if (!options.with_scale) fixed.push_back(RigVector::Unit(kRigParameters, 12));
  if (fit.unobservable) {
    // Where all rotations are about one axis, camera and board may move along it together.
    const Eigen::Vector3d& axis = *fit.unobservable;
    const Eigen::Vector3d axis_world = views[fit.used.front()].T_world_mount.rotation() * axis;
    RigVector both = RigVector::Zero(kRigParameters);
    both.segment<3>(0) = fit.rig.T_mount_camera.rotation().conjugate() * axis;
    both.segment<3>(6) = fit.rig.T_world_board.rotation().conjugate() * axis_world;
    fixed.push_back(both.normalized());
  }
  Eigen::MatrixXd columns = Eigen::MatrixXd::Identity(kRigParameters, kRigParameters);
  if (fixed.empty()) return columns;
  Eigen::MatrixXd spanned(kRigParameters, static_cast<Eigen::Index>(fixed.size()));
  for (std::size_t i = 0; i < fixed.size(); ++i)
    spanned.col(static_cast<Eigen::Index>(i)) = fixed[i];
  const Eigen::HouseholderQR<Eigen::MatrixXd> decomposition(spanned);
  const Eigen::MatrixXd Q = decomposition.householderQ() * columns;
  return Q.rightCols(kRigParameters - spanned.cols());
}

double variance_change(const NoiseShape& shape, const Variances& before, const Variances& after) {
  const Matrix6d weight = covariance_of(shape, before).inverse();
  double change = 0.0;
  for (std::size_t source = 0; source < kSources; ++source) {
    const double share =
        before[source] * (weight * covariance_of_source(shape, source)).trace() / 6.0;
    change += share * std::abs(after[source] / std::max(before[source], 1e-300) - 1.0);
  }
  return change;
}

RotationSpread rotation_spread(const std::vector<RigView>& views,
                               const std::vector<std::size_t>& indices) {
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const std::size_t index : indices) {
    const Eigen::Vector4d q = views[index].T_world_mount.rotation().coeffs();
    scatter += q * q.transpose();
  }
  const Eigen::Quaterniond mean(Eigen::Vector4d(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(scatter).eigenvectors().col(3)));
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t index : indices) {
    const Eigen::Vector3d turn =
        Pose(mean.conjugate() * views[index].T_world_mount.rotation(), Eigen::Vector3d::Zero())
            .log()
            .tail<3>();
    spread += turn * turn.transpose() / static_cast<double>(indices.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  return {std::sqrt(std::max(solver.eigenvalues()[2], 0.0)),
          std::sqrt(std::max(solver.eigenvalues()[1], 0.0)), solver.eigenvectors().col(2)};
}

std::optional<Rig> find_start(const std::vector<RigView>& views,
                              const std::vector<std::size_t>& indices) {
  std::optional<Rig> best;
  double best_score = 0.0;
  const auto consider = [&](std::optional<Rig> rig, const std::vector<std::size_t>& placed) {
    if (!rig) return;
    place_board(views, placed, *rig);
    const double found = score(views, indices, *rig);
    if (best && !(found < best_score)) return;
    best = rig;
    best_score = found;
  };
  const std::vector<MotionPair> all = motion_pairs(views, indices);
  consider(solve_by_park(all, false), indices);
  consider(solve_by_daniilidis(all), indices);
  Random random(kSubsetSeed);
  for (int i = 0; i < kSubsets && indices.size() > kSubsetSize; ++i) {
    const std::vector<std::size_t> few = draw(indices, kSubsetSize, random);
    consider(solve_by_park(motion_pairs(views, few), false), few);
  }
  return best;
}

TypicalResidual typical_residual(const std::vector<RigView>& views,
                                 const std::vector<std::size_t>& indices, const Rig& rig) {
  std::vector<double> positions, rotations;
  for (const std::size_t index : indices) {
    const Vector6d residual = residual_of(views[index], rig);
    positions.push_back(residual.head<3>().norm());
    rotations.push_back(residual.tail<3>().norm());
  }
  return {std::max(median(positions) / kMedianOfThree, kMinUnit),
          std::max(median(rotations) / kMedianOfThree, kMinUnit)};
}

Eigen::Vector3d best_point(const std::vector<RigView>& views, const RigFit& fit) {
  const TypicalResidual typical = typical_residual(views, fit.used, fit.rig);
  const Eigen::Matrix3d R = fit.rig.T_world_board.rotation_matrix();
  // The point p has the residual e + w x (R p), with the residuals e of the origin and w of the
  // rotation.
  const double prior = typical.position * typical.position / (kBoardSize * kBoardSize);
  Eigen::Matrix3d normal = prior * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const std::size_t index : fit.used) {
    const Vector6d residual = residual_of(views[index], fit.rig);
    const Eigen::Matrix3d row = skew(residual.tail<3>()) * R;
    normal += row.transpose() * row;
    right -= row.transpose() * residual.head<3>();
  }
  return normal.ldlt().solve(right);
}

std::vector<LinearView> linearised(const std::vector<RigView>& views,
                                   const std::vector<std::size_t>& indices, const Rig& rig,
                                   CameraMount mount) {
  std::vector<LinearView> linear;
  linear.reserve(indices.size());
  for (const std::size_t index : indices) {
    const RigView& view = views[index];
    linear.push_back(
        {noise_shape(view, rig, mount), residual_of(view, rig), jacobian_of(view, rig)});
  }
  return linear;
}

double squared_distance(const LinearView& view, const RigFit& fit, bool is_used) {
  const Matrix6d of_fit = view.jacobian * fit.covariance * view.jacobian.transpose();
  const Matrix6d of_noise = covariance_of(view.shape, fit.variances);
  // What the fit has taken off a used view's residual, but for a part that keeps it positive.
  constexpr double kMinRest = 0.05;
  const Matrix6d total =
      is_used ? Matrix6d(of_noise - (1.0 - kMinRest) * of_fit) : Matrix6d(of_noise + of_fit);
  return view.residual.dot(total.ldlt().solve(view.residual));
}

double outlier_limit(std::size_t used_views) {
  const double freedom =
      std::max(6.0 * static_cast<double>(used_views) - kRigParameters + 1.0, 1.0);
  return kOutlierLimit * (1.0 + kFewResiduals / freedom);
}

RigFit fit_rig(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
               const Rig& start, const RigFitOptions& options) {
  RigFit fit{.rig = start};
  TypicalResidual typical;
  for (int i = 0; i < 2; ++i) {
    typical = typical_residual(views, indices, fit.rig);
    fit.rig = refine_robustly(views, indices, fit.rig, typical.position, typical.rotation);
  }
  typical = typical_residual(views, indices, fit.rig);
  for (const std::size_t index : indices) {
    const Vector6d residual = residual_of(views[index], fit.rig);
    const double distance =
        residual.head<3>().squaredNorm() / (typical.position * typical.position) +
        residual.tail<3>().squaredNorm() / (typical.rotation * typical.rotation);
    if (distance < kFirstLimit || indices.size() < kMinGated) fit.used.push_back(index);
  }
  fit.unobservable = unobservable_axis(views, fit);
  fit.variances = first_variances(views, fit.used, fit.rig, typical, options.mount);
  for (int iteration = 0; iteration < kMaxIterations; iteration += kGateInterval) {
    const bool has_settled = iterate(views, options, kGateInterval, fit);
    std::vector<std::size_t> explained = explained_views(views, indices, fit, options.mount);
    const bool is_same = explained == fit.used;
    fit.used = std::move(explained);
    if (has_settled && is_same) break;
    if (!is_same) fit.unobservable = unobservable_axis(views, fit);
  }
  (void)iterate(views, options, kGateInterval, fit);
  return fit;
}

RigFit refit_rig(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
                 const RigFit& start, const RigFitOptions& options) {
  RigFit fit = start;
  fit.used = indices;
  (void)iterate(views, options, 3 * kGateInterval, fit);
  return fit;
}

double deviance_with(const std::vector<RigView>& views, const RigFit& fit,
                     const RigFitOptions& options, const std::array<bool, kSources>& sources) {
  RigFit reduced = fit;
  for (std::size_t source = 0; source < kSources; ++source) {
    if (!sources[source]) reduced.variances[source] = 0.0;
  }
  // A source that had vanished may have to explain all.
  const TypicalResidual typical = typical_residual(views, fit.used, fit.rig);
  const Variances start = first_variances(views, fit.used, fit.rig, typical, options.mount);
  for (std::size_t source = 0; source < kSources; ++source) {
    if (sources[source])
      reduced.variances[source] = std::max(reduced.variances[source], start[source]);
  }
  (void)iterate(views, options, 3 * kGateInterval, reduced);
  return deviance(linearised(views, reduced.used, reduced.rig, options.mount), reduced.information,
                  reduced.observable_parameters, reduced.variances);
}

}  // namespace pcavr
