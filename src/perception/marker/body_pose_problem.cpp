// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/body_pose_problem.hpp"

#include <cmath>
#include <limits>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

using CornerJacobian = Eigen::Matrix<double, 2, 6>;
using PlaneJacobian = Eigen::Matrix<double, 3, 6>;

/// Huber's threshold in standard deviations; 1.345 per coordinate keeps 95 % efficiency on Gaussian
/// noise, and the residuals here have two and three coordinates.
constexpr double kHuber = 2.0;
constexpr int kMaxIterations = 30;  ///< bounds the time; ends at convergence
/// Minimum depth of a corner in front of the camera [m].
constexpr double kMinDepth = 1e-3;

/// The tag's plane in the form of PlaneMeasurement, predicted by a pose; its derivative by [v; w].
Eigen::Vector3d predict_plane(const Pose& T_camera_body, const SeenTag& tag,
                              PlaneJacobian* jacobian = nullptr) {
  const Eigen::Matrix3d R_camera_body = T_camera_body.rotation_matrix();
  const Eigen::Vector3d normal_body = tag.T_body_marker.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& centre_body = tag.T_body_marker.translation();
  const Eigen::Vector3d normal = R_camera_body * normal_body;
  const Eigen::Vector3d centre = T_camera_body * centre_body;
  const double distance = normal.dot(centre);
  if (jacobian != nullptr) {
    PlaneJacobian normal_change = PlaneJacobian::Zero();
    normal_change.rightCols<3>() = -R_camera_body * skew(normal_body);
    PlaneJacobian centre_change;
    centre_change << R_camera_body, -R_camera_body * skew(centre_body);
    const Eigen::Matrix<double, 1, 6> distance_change =
        centre.transpose() * normal_change + normal.transpose() * centre_change;
    *jacobian = normal_change / distance - normal * distance_change / (distance * distance);
  }
  return normal / distance;
}

/// Gauss-Newton normal equations, H * step = -g.
struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

void add_tag(const BodyPoseProblem& problem, const SeenTag& tag, const Pose& T_camera_body,
             NormalEquations& equations) {
  const Eigen::Matrix3d R_camera_body = T_camera_body.rotation_matrix();
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_camera = T_camera_body * tag.corners_body[i];
    Eigen::Matrix<double, 3, 6> point_change;
    point_change << R_camera_body, -R_camera_body * skew(tag.corners_body[i]);
    const CornerJacobian jacobian =
        projection_jacobian(problem.camera, p_camera) * point_change / tag.corner_std;
    const Eigen::Vector2d residual =
        (problem.camera.project(p_camera) - tag.pixels[i]) / tag.corner_std;
    const double weight = huber_weight(residual.norm());
    equations.H += weight * jacobian.transpose() * jacobian;
    equations.g += weight * jacobian.transpose() * residual;
  }
  if (!tag.plane) return;
  PlaneJacobian plane_change;
  const Eigen::Vector3d residual =
      tag.plane->sqrt_information *
      (predict_plane(T_camera_body, tag, &plane_change) - tag.plane->m);
  const PlaneJacobian jacobian = tag.plane->sqrt_information * plane_change;
  const double weight = huber_weight(residual.norm());
  equations.H += weight * jacobian.transpose() * jacobian;
  equations.g += weight * jacobian.transpose() * residual;
}

double total_cost(const BodyPoseProblem& problem, const Pose& T_camera_body) {
  double cost = 0.0;
  for (const SeenTag& tag : problem.tags) {
    if (tag.is_used) cost += tag_cost(problem, tag, T_camera_body);
  }
  return cost;
}

NormalEquations equations_at(const BodyPoseProblem& problem, const Pose& T_camera_body) {
  NormalEquations equations;
  for (const SeenTag& tag : problem.tags) {
    if (tag.is_used) add_tag(problem, tag, T_camera_body, equations);
  }
  return equations;
}

double used_corner_rms(const BodyPoseProblem& problem, const Pose& T_camera_body) {
  double sum = 0.0;
  int count = 0;
  for (const SeenTag& tag : problem.tags) {
    if (!tag.is_used) continue;
    const double rms = corner_rms(problem, tag, T_camera_body);
    sum += rms * rms;
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / count);
}

}  // namespace

double huber_weight(double residual) { return residual <= kHuber ? 1.0 : kHuber / residual; }

Eigen::Matrix<double, 2, 3> projection_jacobian(const CameraModel& camera,
                                                const Eigen::Vector3d& p) {
  constexpr double kStep = 1e-5;  // cube root of the rounding error, for central differences
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const auto at = [&](double dx, double dy) { return camera.project({x + dx, y + dy, 1.0}); };
  Eigen::Matrix2d lens;
  lens.col(0) = (at(kStep, 0.0) - at(-kStep, 0.0)) / (2.0 * kStep);
  lens.col(1) = (at(0.0, kStep) - at(0.0, -kStep)) / (2.0 * kStep);
  Eigen::Matrix<double, 2, 3> perspective;
  perspective << 1.0 / p.z(), 0.0, -x / p.z(), 0.0, 1.0 / p.z(), -y / p.z();
  return lens * perspective;
}

double huber_loss(double residual) {
  return residual <= kHuber ? residual * residual : kHuber * (2.0 * residual - kHuber);
}

double corner_rms(const BodyPoseProblem& problem, const SeenTag& tag, const Pose& T_camera_body) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_camera = T_camera_body * tag.corners_body[i];
    if (p_camera.z() < kMinDepth) return std::numeric_limits<double>::infinity();
    sum += (problem.camera.project(p_camera) - tag.pixels[i]).squaredNorm();
  }
  return std::sqrt(sum / 4.0);
}

double tag_cost(const BodyPoseProblem& problem, const SeenTag& tag, const Pose& T_camera_body) {
  double cost = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_camera = T_camera_body * tag.corners_body[i];
    if (p_camera.z() < kMinDepth) return std::numeric_limits<double>::infinity();
    cost += huber_loss((problem.camera.project(p_camera) - tag.pixels[i]).norm() / tag.corner_std);
  }
  if (tag.plane) {
    const Eigen::Vector3d difference = predict_plane(T_camera_body, tag) - tag.plane->m;
    cost += huber_loss((tag.plane->sqrt_information * difference).norm());
  }
  return cost;
}

std::optional<RefinedPose> refine_body_pose(const BodyPoseProblem& problem, const Pose& start) {
  Pose pose = start;
  double cost = total_cost(problem, pose);
  if (!std::isfinite(cost)) return std::nullopt;
  double damping = 1e-4;  // Levenberg-Marquardt, of the diagonal [Marquardt 1963]
  for (int i = 0; i < kMaxIterations; ++i) {
    const NormalEquations equations = equations_at(problem, pose);
    Matrix6d damped = equations.H;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = -damped.ldlt().solve(equations.g);
    if (!step.allFinite()) return std::nullopt;
    const Pose next = pose * Pose::exp(step);
    const double next_cost = total_cost(problem, next);
    const bool is_better = next_cost <= cost;
    const double gain = cost - next_cost;
    damping = is_better ? damping * 0.1 : damping * 10.0;
    if (is_better) {
      pose = next;
      cost = next_cost;
    }
    if (damping > 1e8 || (is_better && gain < 1e-9 * (1.0 + cost))) break;
  }
  return RefinedPose{pose, cost, used_corner_rms(problem, pose), equations_at(problem, pose).H};
}

}  // namespace pcavr
