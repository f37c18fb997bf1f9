// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/object_fit.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

#include "perception/tracking/object_contour.hpp"
#include "perception/tracking/object_samples.hpp"

namespace pcavr::tracking {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using ImageJacobian = Eigen::Matrix<double, 2, 6>;

/// Huber's threshold for corners and contour, in standard deviations: 99 % efficiency.
constexpr double kHuber = 2.0;
/// A sample further from the surface than this many standard deviations is an outlier: 1 in 16 000
/// of normal noise.
constexpr double kGate = 4.0;
constexpr int kMaxIterations = 12;  // the capture range is halved in each
/// Below this capture range only the noise gate is used: a few standard deviations at 1 m [m].
constexpr double kMinCaptureRange = 0.005;
/// Convergence: a step below these ends the iteration; a tenth of the accuracy of a single frame.
constexpr double kMinTranslationStep = 2e-5;  // [m]
constexpr double kMinRotationStep = 1e-4;     // [rad]

/// Gauss-Newton normal equations H * step = b of [v; w; bias].
struct FitEquations {
  Matrix7d H = Matrix7d::Zero();
  Vector7d b = Vector7d::Zero();
};

double incidence(const SurfaceSample& sample) {
  const double cosine = -sample.normal_object.dot(sample.ray_object) / sample.ray_object.norm();
  return std::acos(std::clamp(cosine, 0.0, 1.0));
}

double sample_std(const FitProblem& problem, const SurfaceSample& sample) {
  return problem.options.depth_noise.depth_std(sample.expected_depth, incidence(sample));
}

/// d(pixel)/d[v; w] of a point of the object; z > 0.
ImageJacobian image_jacobian(const CameraModel& camera, const Pose& T_camera_object,
                             const Eigen::Vector3d& p_object) {
  const Eigen::Vector3d p = T_camera_object * p_object;
  Eigen::Matrix<double, 2, 3> perspective;
  if (camera.has_distortion()) {
    perspective = camera.projection_jacobian(p);
  } else {
    perspective << camera.fx / p.z(), 0.0, -camera.fx * p.x() / (p.z() * p.z()),  //
        0.0, camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
  }
  const Eigen::Matrix3d R = T_camera_object.rotation_matrix();
  Eigen::Matrix<double, 3, 6> point_change;
  point_change << R, -R * skew(p_object);
  return perspective * point_change;
}

/// `residual` in standard deviations.
double huber_weight(double residual) { return residual <= kHuber ? 1.0 : kHuber / residual; }

void add_corner(const FitProblem& problem, const CornerObservation& corner,
                const Pose& T_camera_color, FitEquations& equations) {
  const Eigen::Vector3d p = T_camera_color * corner.p_object;
  if (p.z() <= 0.0) return;
  const double corner_std = problem.options.body_pose.corner_std;
  const Eigen::Vector2d residual = reprojection_error(problem.camera, corner, p) / corner_std;
  const ImageJacobian jacobian =
      image_jacobian(problem.camera, T_camera_color, corner.p_object) / corner_std;
  const double weight = huber_weight(residual.norm());
  equations.H.topLeftCorner<6, 6>() += weight * jacobian.transpose() * jacobian;
  equations.b.head<6>() += weight * jacobian.transpose() * residual;
}

void add_contour(const FitProblem& problem, const Pose& T_camera_object, FitEquations& equations) {
  const double contour_std = problem.options.contour_std;
  for (const ContourMatch& match :
       match_contour(problem.surface_object, problem.depth_camera, problem.depth,
                     problem.options.depth_noise, T_camera_object)) {
    const Vector6d jacobian =
        image_jacobian(problem.depth_camera, T_camera_object, match.p_object).transpose() *
        match.normal / contour_std;
    const double residual = match.outward_pixels / contour_std;
    const double weight = huber_weight(std::abs(residual));
    equations.H.topLeftCorner<6, 6>() += weight * jacobian * jacobian.transpose();
    equations.b.head<6>() += weight * residual * jacobian;
  }
}

/// A displacement dp of a surface point changes the depth along its ray by n.dp / n.ray.
Vector7d depth_jacobian(const SurfaceSample& sample) {
  Vector7d jacobian;
  jacobian << sample.normal_object, sample.p_object.cross(sample.normal_object),
      sample.normal_object.dot(sample.ray_object);
  return jacobian / sample.normal_object.dot(sample.ray_object);
}

/// Weight of Tukey's biweight loss: zero beyond the gate.
double tukey_weight(double ratio_to_gate) {
  if (ratio_to_gate >= 1.0) return 0.0;
  const double root = 1.0 - ratio_to_gate * ratio_to_gate;
  return root * root;
}

void add_depth(const FitProblem& problem, const std::vector<SurfaceSample>& samples, int stride,
               double bias, double capture_range, FitEquations& equations) {
  const double area = static_cast<double>(stride * stride);
  const double correlation_length = problem.options.depth_correlation_length;
  const double independent_share = std::min(1.0, area / (correlation_length * correlation_length));
  for (const SurfaceSample& sample : samples) {
    const double std_dev = sample_std(problem, sample);
    const double residual = sample.measured_depth - sample.expected_depth - bias;
    const double gate = std::max(kGate * std_dev, capture_range);
    const double weight =
        independent_share * tukey_weight(std::abs(residual) / gate) / (std_dev * std_dev);
    if (weight == 0.0) continue;
    const Vector7d jacobian = depth_jacobian(sample);
    equations.H += weight * jacobian * jacobian.transpose();
    equations.b += weight * residual * jacobian;
  }
}

/// Information of the pose with the common bias marginalised (Schur complement).
Matrix6d marginalise_bias(const Matrix7d& H) {
  return H.topLeftCorner<6, 6>() - H.topRightCorner<6, 1>() * H.bottomLeftCorner<1, 6>() / H(6, 6);
}

double bias_information(const FitProblem& problem, const Pose& T_camera_object) {
  const double z = T_camera_object.translation().z();
  const double bias_std = std::max(problem.options.depth_bias * z * z, 1e-6);
  return 1.0 / (bias_std * bias_std);
}

ShapeAgreement evaluate_agreement(const FitProblem& problem,
                                  const std::vector<SurfaceSample>& samples, double bias) {
  ShapeAgreement agreement;
  double sum_squares = 0.0;
  double sum_normalised_squares = 0.0;
  for (const SurfaceSample& sample : samples) {
    const double std_dev = sample_std(problem, sample);
    const double residual = sample.measured_depth - sample.expected_depth - bias;
    if (residual < -kGate * std_dev) {
      ++agreement.occluded;
    } else if (residual > kGate * std_dev) {
      ++agreement.behind;
    } else {
      ++agreement.inliers;
      sum_squares += residual * residual;
      sum_normalised_squares += residual * residual / (std_dev * std_dev);
    }
  }
  if (agreement.inliers > 0) {
    agreement.rms = std::sqrt(sum_squares / agreement.inliers);
    agreement.normalised_rms = std::sqrt(sum_normalised_squares / agreement.inliers);
  }
  return agreement;
}

void add_prior(const PosePrior& prior, const Pose& T_camera_object, FitEquations& equations) {
  const Vector6d error = (prior.T_camera_object.inverse() * T_camera_object).log();
  equations.H.topLeftCorner<6, 6>() += prior.information;
  equations.b.head<6>() -= prior.information * error;
}

}  // namespace

Eigen::Vector2d reprojection_error(const CameraModel& camera, const CornerObservation& corner,
                                   const Eigen::Vector3d& p_camera) {
  if (camera.has_distortion()) {
    return camera.project(corner.ray.homogeneous()) - camera.project(p_camera);
  }
  return Eigen::Vector2d(camera.fx, camera.fy)
      .cwiseProduct(corner.ray - p_camera.head<2>() / p_camera.z());
}

FitResult fit_object(const FitProblem& problem, const Pose& start, double capture_range) {
  const SampleGrid grid(problem.surface_object, problem.normals_object, problem.depth_camera,
                        problem.depth, start, problem.options.max_samples);
  FitResult result;
  result.T_camera_object = start;
  double bias = 0.0;
  for (int i = 0; i < kMaxIterations && !result.is_converged; ++i) {
    FitEquations corners;
    const Pose T_camera_color = result.T_camera_object * problem.motion_to_color;
    for (const CornerObservation& corner : problem.corners) {
      add_corner(problem, corner, T_camera_color, corners);
    }
    FitEquations depth;
    depth.H(6, 6) = bias_information(problem, result.T_camera_object);
    depth.b(6) = -depth.H(6, 6) * bias;
    add_depth(problem, grid.samples(result.T_camera_object), grid.stride(), bias, capture_range,
              depth);
    if (problem.corners.empty()) add_contour(problem, result.T_camera_object, depth);
    result.corner_information = corners.H.topLeftCorner<6, 6>();
    result.depth_information = marginalise_bias(depth.H);

    FitEquations all{corners.H + depth.H, corners.b + depth.b};
    if (problem.prior) add_prior(*problem.prior, result.T_camera_object, all);
    const Vector7d step = all.H.ldlt().solve(all.b);
    if (!step.allFinite()) break;
    result.T_camera_object = result.T_camera_object * Pose::exp(step.head<6>());
    bias += step(6);
    result.is_converged = capture_range == 0.0 && step.head<3>().norm() < kMinTranslationStep &&
                          step.segment<3>(3).norm() < kMinRotationStep;
    capture_range = capture_range > kMinCaptureRange ? 0.5 * capture_range : 0.0;
  }
  result.agreement = evaluate_agreement(problem, grid.samples(result.T_camera_object), bias);
  return result;
}

ShapeAgreement evaluate_shape(const FitProblem& problem, const Pose& T_camera_object) {
  const SampleGrid grid(problem.surface_object, problem.normals_object, problem.depth_camera,
                        problem.depth, T_camera_object, problem.options.max_samples);
  return evaluate_agreement(problem, grid.samples(T_camera_object), 0.0);
}

}  // namespace pcavr::tracking
