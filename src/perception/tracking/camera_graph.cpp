// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <ceres/ceres.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr::tracking {
namespace {

/// SuiteSparse is not used: the summation order of its BLAS differs from run to run, hence the last
/// bits.
constexpr ceres::SparseLinearAlgebraLibraryType kSparseLibrary = ceres::EIGEN_SPARSE;

// Scales of the robust losses, in standard deviations. Cauchy's loss is redescending and so rejects
// outliers.
constexpr double kCornerLossScale = 3.0;

constexpr double kPriorLossScale = 3.0;  // as for corners: groundtruth.txt has outliers, too
// Huber's loss: links were validated frame by frame, so they keep their influence.
constexpr double kLinkLossScale = 3.0;

/// qx qy qz qw, tx ty tz: of T_base_node.
using Block = std::array<double, 7>;

Block to_block(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  const Eigen::Vector3d& t = pose.translation();
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

template <typename T>
using Rotation = Eigen::Map<const Eigen::Quaternion<T>>;
template <typename T>
using Position = Eigen::Map<const Eigen::Matrix<T, 3, 1>>;

/// [v; w] of measured^-1 * estimated, to first order in w.
template <typename T>
Eigen::Matrix<T, 6, 1> pose_error(const Pose& measured, const Eigen::Quaternion<T>& rotation,
                                  const Eigen::Matrix<T, 3, 1>& position) {
  const Eigen::Quaternion<T> q_inverse = measured.rotation().conjugate().cast<T>();
  Eigen::Quaternion<T> q = q_inverse * rotation;
  if (q.w() < T(0)) q.coeffs() = -q.coeffs();
  Eigen::Matrix<T, 6, 1> error;
  error.template head<3>() = q_inverse * (position - measured.translation().cast<T>());
  error.template tail<3>() = T(2) * q.vec();
  return error;
}

/// Relative pose error of a link (between factor).
struct LinkError {
  Pose T_a_b;
  Matrix6d root_information;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const Rotation<T> q_a(a);
    const Rotation<T> q_b(b);
    const Eigen::Quaternion<T> q_a_b = q_a.conjugate() * q_b;
    const Eigen::Matrix<T, 3, 1> p_a_b =
        q_a.conjugate() * (Position<T>(b + 4) - Position<T>(a + 4));
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residual, 6) =
        root_information.cast<T>() * pose_error<T>(T_a_b, q_a_b, p_a_b);
    return true;
  }
};

struct PriorError {
  Pose T_base_node;
  double position_std = 0.0;
  double rotation_std = 0.0;

  template <typename T>
  bool operator()(const T* node, T* residual) const {
    const Eigen::Matrix<T, 6, 1> error =
        pose_error<T>(T_base_node, Rotation<T>(node), Position<T>(node + 4));
    for (int i = 0; i < 3; ++i) {
      residual[i] = error(i) / position_std;
      residual[i + 3] = error(i + 3) / rotation_std;
    }
    return true;
  }
};

struct CornerError {
  Pose T_color_node;
  Eigen::Vector3d p_base;
  Eigen::Vector2d ray;
  Eigen::Matrix2d lens_jacobian;
  double scale = 0.0;  ///< focal length over corner std

  template <typename T>
  bool operator()(const T* node, T* residual) const {
    const Eigen::Matrix<T, 3, 1> p_node =
        Rotation<T>(node).conjugate() * (p_base.cast<T>() - Position<T>(node + 4));
    const Eigen::Matrix<T, 3, 1> p =
        T_color_node.rotation().cast<T>() * p_node + T_color_node.translation().cast<T>();
    if (p.z() < T(1e-3)) return false;
    const T x = p.x() / p.z() - ray.x();
    const T y = p.y() / p.z() - ray.y();
    residual[0] = scale * (lens_jacobian(0, 0) * x + lens_jacobian(0, 1) * y);
    residual[1] = scale * (lens_jacobian(1, 0) * x + lens_jacobian(1, 1) * y);
    return true;
  }
};

}  // namespace

struct PoseGraph::Problem {
  /// Never reallocated: Ceres orders the covariance's blocks by their addresses, and the last bits
  /// of the sums depend on that order.
  std::vector<Block> blocks;

  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> manifold;
  ceres::CauchyLoss corner_loss{kCornerLossScale};
  ceres::HuberLoss link_loss{kLinkLossScale};
  ceres::LossFunctionWrapper prior_loss{new ceres::CauchyLoss(kPriorLossScale),
                                        ceres::TAKE_OWNERSHIP};
  std::vector<ceres::ResidualBlockId> priors;
  ceres::Problem ceres{options()};

  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }
};

PoseGraph::PoseGraph(std::size_t max_nodes) : problem_(std::make_unique<Problem>()) {
  problem_->blocks.reserve(max_nodes);
}
PoseGraph::~PoseGraph() = default;
PoseGraph::PoseGraph(PoseGraph&&) noexcept = default;

std::size_t PoseGraph::add_node(const Pose& T_base_node) {
  PCAVR_REQUIRE(problem_->blocks.size() < problem_->blocks.capacity());
  problem_->blocks.push_back(to_block(T_base_node));
  problem_->ceres.AddParameterBlock(problem_->blocks.back().data(), 7, &problem_->manifold);
  return problem_->blocks.size() - 1;
}

void PoseGraph::add_link(std::size_t a, std::size_t b, const Pose& T_a_b,
                         const Matrix6d& information) {
  const Matrix6d root = information.llt().matrixU();
  problem_->ceres.AddResidualBlock(
      new ceres::AutoDiffCostFunction<LinkError, 6, 7, 7>(new LinkError{T_a_b, root}),
      &problem_->link_loss, problem_->blocks[a].data(), problem_->blocks[b].data());
}

void PoseGraph::add_corners(const CornerFactor& corners) {
  const Pose T_color_node = corners.T_node_color.inverse();
  for (std::size_t i = 0; i < 4; ++i) {
    problem_->ceres.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CornerError, 2, 7>(
            new CornerError{T_color_node, corners.p_base[i], corners.rays[i],
                            corners.lens_jacobians[i], corners.focal_length / corners.corner_std}),
        &problem_->corner_loss, problem_->blocks[corners.node].data());
  }
}

void PoseGraph::add_prior(std::size_t node, const Pose& T_base_node, double position_std,
                          double rotation_std) {
  PCAVR_REQUIRE(position_std > 0.0 && rotation_std > 0.0, position_std, rotation_std);
  problem_->priors.push_back(
      problem_->ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorError, 6, 7>(
                                           new PriorError{T_base_node, position_std, rotation_std}),
                                       &problem_->prior_loss, problem_->blocks[node].data()));
}

void PoseGraph::solve() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = kSparseLibrary;
  options.num_threads = 1;  // deterministic order of summation
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_->ceres, &summary);
}

double PoseGraph::prior_scatter(std::size_t gauges) const {
  std::vector<double> squares;
  for (const ceres::ResidualBlockId prior : problem_->priors) {
    Vector6d error;
    (void)problem_->ceres.EvaluateResidualBlockAssumingParametersUnchanged(prior, false, nullptr,
                                                                           error.data(), nullptr);
    squares.push_back(error.squaredNorm());
  }
  const double freedoms = 6.0 * (static_cast<double>(squares.size()) - static_cast<double>(gauges));
  const double all = std::accumulate(squares.begin(), squares.end(), 0.0);
  if (freedoms < 1.0 || all < freedoms + 3.0 * std::sqrt(2.0 * freedoms)) return 1.0;
  // Fixed point: the scatter of the errors, less those that are outliers at this scatter.
  constexpr int kIterations = 20;                                       // converges in ten
  constexpr double kOutlier = 6.0 * kPriorLossScale * kPriorLossScale;  // of six axes
  double variance = 1.0;
  for (int i = 0; i < kIterations; ++i) {
    double weights = 0.0;
    double sum = 0.0;
    for (const double square : squares) {
      const double weight = 1.0 / (1.0 + square / variance / kOutlier);
      weights += weight;
      sum += weight * square;
    }
    variance = std::max(1.0, sum / (6.0 * std::max(1.0, weights - static_cast<double>(gauges))));
  }
  return std::sqrt(variance);
}

void PoseGraph::scale_priors(double factor) {
  PCAVR_REQUIRE(factor > 0.0, factor);
  // The loss of a residual that is divided by the factor.
  problem_->prior_loss.Reset(new ceres::ScaledLoss(new ceres::CauchyLoss(factor * kPriorLossScale),
                                                   1.0 / (factor * factor), ceres::TAKE_OWNERSHIP),
                             ceres::TAKE_OWNERSHIP);
}

const Pose PoseGraph::pose(std::size_t node) const {
  const Block& block = problem_->blocks[node];
  return {Eigen::Quaterniond(block[3], block[0], block[1], block[2]),
          Eigen::Vector3d(block[4], block[5], block[6])};
}

std::vector<std::optional<NodeStd>> PoseGraph::node_stds(
    const std::vector<std::size_t>& nodes) const {
  std::vector<std::optional<NodeStd>> stds(nodes.size());
  std::vector<std::pair<const double*, const double*>> pairs;
  for (const std::size_t node : nodes) {
    const double* block = problem_->blocks[node].data();
    pairs.emplace_back(block, block);
  }
  ceres::Covariance::Options options;
  options.sparse_linear_algebra_library_type = kSparseLibrary;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  if (pairs.empty() || !covariance.Compute(pairs, &problem_->ceres)) return stds;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Matrix6d tangent;
    const double* block = pairs[i].first;
    if (!covariance.GetCovarianceBlockInTangentSpace(block, block, tangent.data())) continue;
    // The quaternion manifold's tangent is half the rotation vector.
    stds[i] = NodeStd{std::sqrt(tangent.bottomRightCorner<3, 3>().trace()),
                      2.0 * std::sqrt(tangent.topLeftCorner<3, 3>().trace())};
  }
  return stds;
}

std::array<double, 4> PoseGraph::corner_errors(const CornerFactor& corners) const {
  const Pose T_color_base = (pose(corners.node) * corners.T_node_color).inverse();
  std::array<double, 4> errors{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p = T_color_base * corners.p_base[i];
    errors[i] = p.z() > 0.0
                    ? corners.focal_length *
                          (corners.lens_jacobians[i] * (p.hnormalized() - corners.rays[i])).norm()
                    : HUGE_VAL;
  }
  return errors;
}

}  // namespace pcavr::tracking
