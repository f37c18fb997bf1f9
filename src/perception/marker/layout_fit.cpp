// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/layout_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

#include "perception/marker/body_pose_problem.hpp"

namespace pcavr {
namespace {

constexpr int kMaxLayoutIterations = 50;  // bounds the time; ends at convergence
constexpr double kMinLayoutDepth = 1e-3;  ///< [m] nearer points are not in the image
/// Blocks of successive views whose sums show the correlation of their residuals: enough to average
/// over, and each long against the time in which a view changes.
constexpr std::size_t kBlocks = 16;

using PoseJacobian = Eigen::Matrix<double, 3, 6>;

PoseJacobian point_by_twist(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  PoseJacobian jacobian;
  jacobian << R, -R * skew(p);
  return jacobian;
}

/// A tag's part of a view's normal equations.
struct TagEquations {
  std::size_t tag = 0;
  Matrix6d mixed = Matrix6d::Zero();  ///< camera x tag
  Matrix6d own = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

struct LayoutEquations {
  Matrix6d camera = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  std::vector<TagEquations> tags = {};
};

LayoutEquations view_equations(const LayoutProblem& problem, const LayoutView& view) {
  LayoutEquations equations;
  const Eigen::Matrix3d R_camera_layout = view.T_camera_layout.rotation_matrix();
  for (const SeenCorners& seen : view.seen) {
    if (!seen.is_used) continue;
    const Pose& T_layout_tag = problem.T_layout_tag[seen.tag];
    const Eigen::Matrix3d R_camera_tag = R_camera_layout * T_layout_tag.rotation_matrix();
    const std::array<Eigen::Vector3d, 4> corners = tag_corners(problem.sizes[seen.tag]);
    TagEquations tag{.tag = seen.tag};
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p_layout = T_layout_tag * corners[i];
      const Eigen::Vector3d p_camera = view.T_camera_layout * p_layout;
      const Eigen::Vector2d residual =
          (problem.camera.project(p_camera) - seen.pixels[i]) / seen.corner_std;
      const double weight = huber_weight(residual.norm());
      const Eigen::Matrix<double, 2, 3> lens =
          problem.camera.projection_jacobian(p_camera) / seen.corner_std;
      const Eigen::Matrix<double, 2, 6> J = lens * point_by_twist(R_camera_layout, p_layout);
      const Eigen::Matrix<double, 2, 6> K = lens * point_by_twist(R_camera_tag, corners[i]);
      equations.camera += weight * J.transpose() * J;
      equations.gradient += weight * J.transpose() * residual;
      tag.mixed += weight * J.transpose() * K;
      tag.own += weight * K.transpose() * K;
      tag.gradient += weight * K.transpose() * residual;
    }
    if (seen.tag != problem.datum) equations.tags.push_back(tag);
  }
  return equations;
}

/// Rows of a tag among the unknowns; the datum has none.
Eigen::Index row_of(const LayoutProblem& problem, std::size_t tag) {
  return 6 * static_cast<Eigen::Index>(tag > problem.datum ? tag - 1 : tag);
}

Eigen::Index unknowns_of(const LayoutProblem& problem) {
  return 6 * (static_cast<Eigen::Index>(problem.sizes.size()) - 1);
}

/// The equations of the tags alone: the cameras are eliminated (Schur complement).
struct ReducedEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  std::vector<LayoutEquations> views = {};
};

void add_gradient(const LayoutProblem& problem, const LayoutEquations& view,
                  const Eigen::LDLT<Matrix6d>& camera, Eigen::VectorXd& gradient) {
  const Vector6d camera_step = camera.solve(view.gradient);
  for (const TagEquations& tag : view.tags) {
    gradient.segment<6>(row_of(problem, tag.tag)) +=
        tag.gradient - tag.mixed.transpose() * camera_step;
  }
}

void add_reduced(const LayoutProblem& problem, const LayoutEquations& view,
                 ReducedEquations& reduced) {
  const Eigen::LDLT<Matrix6d> camera(view.camera);
  add_gradient(problem, view, camera, reduced.gradient);
  for (const TagEquations& a : view.tags) {
    const Eigen::Index row = row_of(problem, a.tag);
    const Matrix6d eliminated = camera.solve(a.mixed);
    reduced.matrix.block<6, 6>(row, row) += a.own;
    for (const TagEquations& b : view.tags) {
      reduced.matrix.block<6, 6>(row_of(problem, b.tag), row) -= b.mixed.transpose() * eliminated;
    }
  }
}

ReducedEquations reduced_equations(const LayoutProblem& problem, double damping) {
  const Eigen::Index n = unknowns_of(problem);
  ReducedEquations reduced{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const LayoutView& view : problem.views) {
    LayoutEquations& equations = reduced.views.emplace_back(view_equations(problem, view));
    equations.camera.diagonal() *= 1.0 + damping;
    for (TagEquations& tag : equations.tags) tag.own.diagonal() *= 1.0 + damping;
    add_reduced(problem, equations, reduced);
  }
  return reduced;
}

LayoutProblem stepped(const LayoutProblem& problem, double damping) {
  const ReducedEquations reduced = reduced_equations(problem, damping);
  const Eigen::VectorXd change = -reduced.matrix.ldlt().solve(reduced.gradient);
  LayoutProblem next = problem;
  for (std::size_t tag = 0; tag < problem.sizes.size(); ++tag) {
    if (tag == problem.datum) continue;
    const Vector6d twist = change.segment<6>(row_of(problem, tag));
    if (twist.allFinite()) next.T_layout_tag[tag] = problem.T_layout_tag[tag] * Pose::exp(twist);
  }
  for (std::size_t i = 0; i < problem.views.size(); ++i) {
    const LayoutEquations& view = reduced.views[i];
    Vector6d gradient = view.gradient;
    for (const TagEquations& tag : view.tags) {
      gradient += tag.mixed * change.segment<6>(row_of(problem, tag.tag));
    }
    const Vector6d twist = -view.camera.ldlt().solve(gradient);
    if (!twist.allFinite()) continue;
    next.views[i].T_camera_layout = problem.views[i].T_camera_layout * Pose::exp(twist);
  }
  return next;
}

bool is_before_camera(const LayoutProblem& problem, const LayoutView& view,
                      const SeenCorners& seen) {
  for (const Eigen::Vector3d& corner : tag_corners(problem.sizes[seen.tag])) {
    const Eigen::Vector3d p = view.T_camera_layout * (problem.T_layout_tag[seen.tag] * corner);
    if (p.z() < kMinLayoutDepth) return false;
  }
  return true;
}

double robust_cost(const LayoutProblem& problem) {
  double cost = 0.0;
  for (const LayoutView& view : problem.views) {
    for (const SeenCorners& seen : view.seen) {
      if (!seen.is_used) continue;
      if (!is_before_camera(problem, view, seen)) return std::numeric_limits<double>::infinity();
      const std::array<Eigen::Vector3d, 4> corners = tag_corners(problem.sizes[seen.tag]);
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d p =
            view.T_camera_layout * (problem.T_layout_tag[seen.tag] * corners[i]);
        cost += huber_loss((problem.camera.project(p) - seen.pixels[i]).norm() / seen.corner_std);
      }
    }
  }
  return cost;
}

double variance_factor_of(const LayoutProblem& problem) {
  double residuals = 0.0;
  for (const LayoutView& view : problem.views) {
    residuals += 8.0 * static_cast<double>(view.used()) - 6.0;
  }
  residuals -= static_cast<double>(unknowns_of(problem));
  return robust_cost(problem) / std::max(1.0, residuals);
}

/// Sums of the views' gradients over blocks of successive ones are larger than by chance where
/// their residuals are correlated: the ratio of the two, in the metric of the estimate.
double correlation_of(const LayoutProblem& problem, const ReducedEquations& reduced,
                      const Eigen::LDLT<Eigen::MatrixXd>& factors) {
  const std::size_t count = problem.views.size();
  const std::size_t blocks = std::min(kBlocks, count / 2);
  if (blocks < 2) return 1.0;
  double alone = 0.0, together = 0.0;
  Eigen::VectorXd sum(unknowns_of(problem)), one(unknowns_of(problem));
  for (std::size_t block = 0; block < blocks; ++block) {
    sum.setZero();
    for (std::size_t i = block * count / blocks; i < (block + 1) * count / blocks; ++i) {
      const LayoutEquations& view = reduced.views[i];
      one.setZero();
      add_gradient(problem, view, Eigen::LDLT<Matrix6d>(view.camera), one);
      alone += one.dot(factors.solve(one));
      sum += one;
    }
    together += sum.dot(factors.solve(sum));
  }
  if (!(alone > 0.0)) return 1.0;
  // The gradients' sum over all views is zero, which takes one block's worth from the blocks'.
  const double b = static_cast<double>(blocks);
  return std::max(1.0, together * b / (b - 1.0) / alone);
}

}  // namespace

std::size_t LayoutView::used() const {
  return static_cast<std::size_t>(std::count_if(
      seen.begin(), seen.end(), [](const SeenCorners& corners) { return corners.is_used; }));
}

double LayoutProblem::mean_square(const LayoutView& view, const SeenCorners& seen) const {
  if (!is_before_camera(*this, view, seen)) return std::numeric_limits<double>::infinity();
  const std::array<Eigen::Vector3d, 4> corners = tag_corners(sizes[seen.tag]);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p = view.T_camera_layout * (T_layout_tag[seen.tag] * corners[i]);
    sum += (camera.project(p) - seen.pixels[i]).squaredNorm();
  }
  return sum / (4.0 * seen.corner_std * seen.corner_std);
}

bool fit_layout(LayoutProblem& problem) {
  double cost = robust_cost(problem);
  double damping = 1e-4;
  for (int i = 0; i < kMaxLayoutIterations && std::isfinite(cost) && damping < 1e8; ++i) {
    LayoutProblem next = stepped(problem, damping);
    const double next_cost = robust_cost(next);
    const double gain = cost - next_cost;
    if (!(gain >= 0.0)) {
      damping *= 10.0;
      continue;
    }
    damping *= 0.1;
    problem = std::move(next);
    cost = next_cost;
    if (gain < 1e-9 * (1.0 + cost)) break;
  }
  return std::isfinite(cost);
}

LayoutCovariance layout_covariance(const LayoutProblem& problem) {
  const ReducedEquations reduced = reduced_equations(problem, 0.0);
  const Eigen::LDLT<Eigen::MatrixXd> factors(reduced.matrix);
  const Eigen::Index n = unknowns_of(problem);
  LayoutCovariance covariance{Eigen::MatrixXd::Zero(n + 6, n + 6)};
  covariance.variance_factor = variance_factor_of(problem);
  covariance.correlation = correlation_of(problem, reduced, factors);
  const Eigen::MatrixXd inverse = covariance.variance_factor * covariance.correlation *
                                  factors.solve(Eigen::MatrixXd::Identity(n, n)).eval();
  for (std::size_t a = 0; a < problem.sizes.size(); ++a) {
    for (std::size_t b = 0; b < problem.sizes.size(); ++b) {
      if (a == problem.datum || b == problem.datum) continue;
      covariance.matrix.block<6, 6>(6 * static_cast<Eigen::Index>(a),
                                    6 * static_cast<Eigen::Index>(b)) =
          inverse.block<6, 6>(row_of(problem, a), row_of(problem, b));
    }
  }
  return covariance;
}

}  // namespace pcavr
