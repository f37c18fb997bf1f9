// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tracking/object_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "tracking/object_rim.hpp"
#include "tracking/object_samples.hpp"

namespace pcavr::tracking {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using ImageJacobian = Eigen::Matrix<double, 2, 6>;

/// Huber's threshold for corners and outline, in deviations.
constexpr double kHuber = 2.0;
/// Of one place on the outline [px]: depth images lose a pixel or two there, or gain one.
constexpr double kRimSigma = 2.0;
/// A sample further from the surface than this many deviations belongs to something else.
constexpr double kGate = 4.0;
constexpr int kMaxIterations = 12;
/// Below this a wider gate than the noise gives draws nothing more in [m].
constexpr double kMinCapture = 0.005;
/// A step below these ends the iteration: a tenth of what a single frame can tell.
constexpr double kMinShift = 2e-5;  // [m]
constexpr double kMinTurn = 1e-4;   // [rad]
/// Pixels nearer to each other than this share their noise: block matching uses windows of about
/// nine pixels, weighted to the middle.
constexpr double kCorrelationLength = 4.0;  // [px]

/// Normal equations of [v; w; bias].
struct Equations {
  Matrix7d left = Matrix7d::Zero();
  Vector7d right = Vector7d::Zero();
};

double incidence(const SurfaceSample& sample) {
  const double cosine = -sample.normal_object.dot(sample.ray_object) / sample.ray_object.norm();
  return std::acos(std::clamp(cosine, 0.0, 1.0));
}

double deviation(const FitProblem& problem, const SurfaceSample& sample) {
  return problem.noise.sigma(sample.expected_depth, incidence(sample));
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

double huber_weight(double deviations) { return deviations <= kHuber ? 1.0 : kHuber / deviations; }

void add_corner(const FitProblem& problem, const CornerSight& corner, const Pose& T_camera_color,
                Equations& equations) {
  const Eigen::Vector3d p = T_camera_color * corner.p_object;
  if (p.z() <= 0.0) return;
  const Eigen::Vector2d residual = corner_offset(problem.camera, corner, p) / problem.corner_sigma;
  const ImageJacobian jacobian =
      image_jacobian(problem.camera, T_camera_color, corner.p_object) / problem.corner_sigma;
  const double weight = huber_weight(residual.norm());
  equations.left.topLeftCorner<6, 6>() += weight * jacobian.transpose() * jacobian;
  equations.right.head<6>() += weight * jacobian.transpose() * residual;
}

void add_rim(const FitProblem& problem, const Pose& T_camera_object, Equations& equations) {
  for (const RimSight& sight : find_rim(problem.surface_object, problem.depth_camera, problem.depth,
                                        problem.noise, T_camera_object)) {
    const Vector6d jacobian =
        image_jacobian(problem.depth_camera, T_camera_object, sight.p_object).transpose() *
        sight.normal / kRimSigma;
    const double residual = sight.outward_pixels / kRimSigma;
    const double weight = huber_weight(std::abs(residual));
    equations.left.topLeftCorner<6, 6>() += weight * jacobian * jacobian.transpose();
    equations.right.head<6>() += weight * residual * jacobian;
  }
}

/// A surface point that moves by dp changes the depth along its ray by n.dp / n.ray.
Vector7d depth_jacobian(const SurfaceSample& sample) {
  Vector7d jacobian;
  jacobian << sample.normal_object, sample.p_object.cross(sample.normal_object),
      sample.normal_object.dot(sample.ray_object);
  return jacobian / sample.normal_object.dot(sample.ray_object);
}

/// Tukey's biweight: what lies beyond the gate has no pull at all.
double tukey_weight(double share_of_gate) {
  if (share_of_gate >= 1.0) return 0.0;
  const double rest = 1.0 - share_of_gate * share_of_gate;
  return rest * rest;
}

void add_depth(const FitProblem& problem, const std::vector<SurfaceSample>& samples, int stride,
               double bias, double capture, Equations& equations) {
  const double area = static_cast<double>(stride * stride);
  const double independence = std::min(1.0, area / (kCorrelationLength * kCorrelationLength));
  for (const SurfaceSample& sample : samples) {
    const double sigma = deviation(problem, sample);
    const double residual = sample.measured_depth - sample.expected_depth - bias;
    const double gate = std::max(kGate * sigma, capture);
    const double weight = independence * tukey_weight(std::abs(residual) / gate) / (sigma * sigma);
    if (weight == 0.0) continue;
    const Vector7d jacobian = depth_jacobian(sample);
    equations.left += weight * jacobian * jacobian.transpose();
    equations.right += weight * residual * jacobian;
  }
}

/// What depth alone says of the pose when the common bias is not known better than its prior.
Matrix6d without_bias(const Matrix7d& left) {
  return left.topLeftCorner<6, 6>() -
         left.topRightCorner<6, 1>() * left.bottomLeftCorner<1, 6>() / left(6, 6);
}

double bias_information(const FitProblem& problem, const Pose& T_camera_object) {
  const double z = T_camera_object.translation().z();
  const double sigma = std::max(problem.depth_bias * z * z, 1e-6);
  return 1.0 / (sigma * sigma);
}

ShapeAgreement agreement_of(const FitProblem& problem, const std::vector<SurfaceSample>& samples,
                            double bias) {
  ShapeAgreement agreement;
  double squares = 0.0;
  double normalised = 0.0;
  for (const SurfaceSample& sample : samples) {
    const double sigma = deviation(problem, sample);
    const double residual = sample.measured_depth - sample.expected_depth - bias;
    if (residual < -kGate * sigma) {
      ++agreement.hidden;
    } else if (residual > kGate * sigma) {
      ++agreement.contradicted;
    } else {
      ++agreement.explained;
      squares += residual * residual;
      normalised += residual * residual / (sigma * sigma);
    }
  }
  if (agreement.explained > 0) {
    agreement.rms = std::sqrt(squares / agreement.explained);
    agreement.chi = std::sqrt(normalised / agreement.explained);
  }
  return agreement;
}

void add_prior(const PosePrior& prior, const Pose& T_camera_object, Equations& equations) {
  const Vector6d off = (prior.T_camera_object.inverse() * T_camera_object).log();
  equations.left.topLeftCorner<6, 6>() += prior.information;
  equations.right.head<6>() -= prior.information * off;
}

}  // namespace

Eigen::Vector2d corner_offset(const CameraModel& camera, const CornerSight& corner,
                              const Eigen::Vector3d& p_camera) {
  if (camera.has_distortion()) {
    return camera.project(corner.on_unit_plane.homogeneous()) - camera.project(p_camera);
  }
  return Eigen::Vector2d(camera.fx, camera.fy)
      .cwiseProduct(corner.on_unit_plane - p_camera.head<2>() / p_camera.z());
}

FitResult fit_object(const FitProblem& problem, const Pose& start, double capture) {
  const SampleGrid grid(problem.surface_object, problem.normals_object, problem.depth_camera,
                        problem.depth, start, problem.max_samples);
  FitResult result;
  result.T_camera_object = start;
  double bias = 0.0;
  for (int i = 0; i < kMaxIterations && !result.is_converged; ++i) {
    Equations corners;
    const Pose T_camera_color = result.T_camera_object * problem.motion_to_color;
    for (const CornerSight& corner : problem.corners) {
      add_corner(problem, corner, T_camera_color, corners);
    }
    Equations depth;
    depth.left(6, 6) = bias_information(problem, result.T_camera_object);
    depth.right(6) = -depth.left(6, 6) * bias;
    add_depth(problem, grid.samples(result.T_camera_object), grid.stride(), bias, capture, depth);
    if (problem.corners.empty()) add_rim(problem, result.T_camera_object, depth);
    result.corner_information = corners.left.topLeftCorner<6, 6>();
    result.depth_information = without_bias(depth.left);

    Equations all{corners.left + depth.left, corners.right + depth.right};
    if (problem.prior) add_prior(*problem.prior, result.T_camera_object, all);
    const Vector7d step = all.left.ldlt().solve(all.right);
    if (!step.allFinite()) break;
    result.T_camera_object = result.T_camera_object * Pose::exp(step.head<6>());
    bias += step(6);
    result.is_converged =
        capture == 0.0 && step.head<3>().norm() < kMinShift && step.segment<3>(3).norm() < kMinTurn;
    capture = capture > kMinCapture ? 0.5 * capture : 0.0;
  }
  result.agreement = agreement_of(problem, grid.samples(result.T_camera_object), bias);
  return result;
}

ShapeAgreement judge_shape(const FitProblem& problem, const Pose& T_camera_object) {
  const SampleGrid grid(problem.surface_object, problem.normals_object, problem.depth_camera,
                        problem.depth, T_camera_object, problem.max_samples);
  return agreement_of(problem, grid.samples(T_camera_object), 0.0);
}

}  // namespace pcavr::tracking
