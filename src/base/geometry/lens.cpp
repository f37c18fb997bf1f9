// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/lens.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

using Coefficients = std::array<double, 8>;
using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Largest angle from the optical axis [rad]; here a ray's length is 11 times its depth.
constexpr double kMaxAngle = 85.0 * std::numbers::pi / 180.0;
/// Bounds of the map's slope (singular values of its Jacobian), which is 1 at the image centre.
/// Below the first the map is about to fold; above the second it approaches a pole, or the
/// polynomial is extrapolated too far beyond its calibration.
constexpr double kMinSlope = 0.01;
constexpr double kMaxSlope = 100.0;
/// Smallest slope of the extrapolation beyond max_radius: a fisheye's slope tends to 0 on the plane
/// z = 1.
constexpr double kMinExtrapolationSlope = 1e-3;
/// The fold is searched in steps of this angle [rad], which resolve any calibrated lens; then
/// refined by bisection.
constexpr double kAngleStep = 0.1 * std::numbers::pi / 180.0;
constexpr int kDirections = 32;
/// Convergence tolerance of undistort() on the plane z = 1.
constexpr double kTolerance = 1e-12;

/// k1 k2 p1 p2 k3. Distorted coordinates on z = 1 and, where asked for, their derivative.
Vector2d plumb_bob(const Coefficients& d, const Vector2d& p, Matrix2d* jacobian) {
  const double k1 = d[0], k2 = d[1], p1 = d[2], p2 = d[3], k3 = d[4];
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  if (jacobian != nullptr) {
    const double slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));  // 2 d(radial)/d(r2)
    (*jacobian) << radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
        x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,  //
        x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
        radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

/// k1 k2 p1 p2 k3 k4 k5 k6.
Vector2d rational(const Coefficients& d, const Vector2d& p, Matrix2d* jacobian) {
  const double p1 = d[2], p2 = d[3];
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double numerator = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double denominator = 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
  const double radial = numerator / denominator;
  if (jacobian != nullptr) {
    const double numerator_slope = d[0] + r2 * (2.0 * d[1] + 3.0 * r2 * d[4]);
    const double denominator_slope = d[5] + r2 * (2.0 * d[6] + 3.0 * r2 * d[7]);
    const double slope = 2.0 * (numerator_slope - radial * denominator_slope) / denominator;
    const double cross = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
    (*jacobian) << radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross,  //
        cross, radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
    // Beyond a zero of the denominator (a pole) the model is meaningless: report it as folded.
    if (!(denominator > 0.0)) jacobian->setConstant(-1.0);
  }
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

struct FisheyeRadius {
  double value = 0.0;
  double slope = 0.0;  ///< d(value)/d(angle)
};

/// Distance from the principal point [focal lengths] for a ray at `angle` to the optical axis.
FisheyeRadius fisheye_radius(const Coefficients& k, double angle) {
  const double a2 = angle * angle;
  return {angle * (1.0 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))),
          1.0 + a2 * (3.0 * k[0] + a2 * (5.0 * k[1] + a2 * (7.0 * k[2] + a2 * 9.0 * k[3])))};
}

/// k1 k2 k3 k4.
Vector2d fisheye(const Coefficients& k, const Vector2d& p, Matrix2d* jacobian) {
  const double r2 = p.squaredNorm();
  // Near the axis the Taylor series is exact to 1e-15 and has no cancellation.
  const bool is_near_axis = r2 < 1e-8;
  const double r = std::sqrt(r2);
  const FisheyeRadius radius = fisheye_radius(k, std::atan(r));
  const double scale = is_near_axis ? 1.0 + (k[0] - 1.0 / 3.0) * r2 : radius.value / r;
  if (jacobian != nullptr) {
    const double scale_slope = is_near_axis ? 2.0 * (k[0] - 1.0 / 3.0)  // d(scale)/dr / r
                                            : (radius.slope / (1.0 + r2) - scale) / r2;
    *jacobian = scale * Matrix2d::Identity() + scale_slope * p * p.transpose();
  }
  return scale * p;
}

/// Whether the radial and tangential slopes lie within the bounds; for a fisheye with respect to
/// the angle, as its slope on the plane z = 1 tends to 0 without a fold.
bool is_locally_invertible(LensModel model, const Coefficients& k, double angle,
                           const Vector2d& direction) {
  // Written so that NaN fails: coefficients may be huge.
  const auto is_in_bounds = [](double slope) { return slope >= kMinSlope && slope <= kMaxSlope; };
  if (model == LensModel::fisheye) {
    const FisheyeRadius radius = fisheye_radius(k, angle);
    return is_in_bounds(radius.slope) && is_in_bounds(radius.value / angle);
  }
  Matrix2d jacobian;
  const Vector2d p = std::tan(angle) * direction;
  (void)(model == LensModel::plumb_bob ? plumb_bob(k, p, &jacobian) : rational(k, p, &jacobian));
  const double radial = direction.dot(jacobian * direction);
  return is_in_bounds(radial) && is_in_bounds(jacobian.determinant() / radial);
}

}  // namespace

std::size_t coefficient_count(LensModel model) {
  switch (model) {
    case LensModel::plumb_bob:
      return 5;
    case LensModel::rational:
      return 8;
    case LensModel::fisheye:
      return 4;
  }
  return 0;
}

std::string_view coefficient_names(LensModel model) {
  switch (model) {
    case LensModel::plumb_bob:
      return "k1 k2 p1 p2 k3";
    case LensModel::rational:
      return "k1 k2 p1 p2 k3 k4 k5 k6";
    case LensModel::fisheye:
      return "k1 k2 k3 k4";
  }
  return "";
}

LensDistortion::LensDistortion(double k1, double k2, double p1, double p2, double k3)
    : LensDistortion(LensModel::plumb_bob, std::array<double, 5>{k1, k2, p1, p2, k3}) {}

LensDistortion::LensDistortion(LensModel model, std::span<const double> coefficients)
    : model_(model) {
  PCAVR_REQUIRE(coefficients.size() == coefficient_count(model), coefficients.size());
  std::copy(coefficients.begin(), coefficients.end(), coefficients_.begin());
  is_none_ = model != LensModel::fisheye && std::all_of(coefficients.begin(), coefficients.end(),
                                                        [](double k) { return k == 0.0; });
  if (!is_none_) find_max_radius();
}

std::span<const double> LensDistortion::coefficients() const {
  return std::span(coefficients_).first(coefficient_count(model_));
}

void LensDistortion::find_max_radius() {
  // Only tangential distortion depends on the direction.
  const bool is_radial =
      model_ == LensModel::fisheye || (coefficients_[2] == 0.0 && coefficients_[3] == 0.0);
  const auto is_one_to_one = [&](double angle) {
    for (int i = 0; i < (is_radial ? 1 : kDirections); ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / kDirections;
      const Vector2d direction(std::cos(azimuth), std::sin(azimuth));
      if (!is_locally_invertible(model_, coefficients_, angle, direction)) return false;
    }
    return true;
  };
  double inside = 0.0;
  double outside = kAngleStep;
  while (outside < kMaxAngle && is_one_to_one(outside)) {
    inside = outside;
    outside += kAngleStep;
  }
  folds_ = outside < kMaxAngle;
  for (int i = 0; folds_ && i < 40; ++i) {
    const double middle = 0.5 * (inside + outside);
    (is_one_to_one(middle) ? inside : outside) = middle;
  }
  max_radius_ = std::tan(inside);
  Matrix2d jacobian;
  (void)formula({max_radius_, 0.0}, &jacobian);
  extrapolation_slope_ = std::max(jacobian(0, 0), kMinExtrapolationSlope);
}

Vector2d LensDistortion::formula(const Vector2d& p, Matrix2d* jacobian) const {
  switch (model_) {
    case LensModel::rational:
      return rational(coefficients_, p, jacobian);
    case LensModel::fisheye:
      return fisheye(coefficients_, p, jacobian);
    case LensModel::plumb_bob:
      break;
  }
  return plumb_bob(coefficients_, p, jacobian);
}

Vector2d LensDistortion::distort(const Vector2d& p, Matrix2d* jacobian) const {
  if (is_none_) {
    if (jacobian != nullptr) jacobian->setIdentity();
    return p;
  }
  if (p.squaredNorm() <= max_radius_ * max_radius_) return formula(p, jacobian);
  return extrapolate(p, jacobian);
}

Vector2d LensDistortion::extrapolate(const Vector2d& p, Matrix2d* jacobian) const {
  const double radius = p.norm();
  const Vector2d direction = p / radius;
  Matrix2d border_jacobian;
  const Vector2d border = formula(max_radius_ * direction, &border_jacobian);
  if (jacobian != nullptr) {
    // d(direction)/dp = (I - d d^T) / radius, and d(radius)/dp = d^T.
    const Matrix2d radial = direction * direction.transpose();
    const Matrix2d tangential = (Matrix2d::Identity() - radial) / radius;
    *jacobian = max_radius_ * border_jacobian * tangential +
                extrapolation_slope_ * ((radius - max_radius_) * tangential + radial);
  }
  return border + extrapolation_slope_ * (radius - max_radius_) * direction;
}

Vector2d LensDistortion::undistort(const Vector2d& q) const {
  if (is_none_) return q;
  if (model_ == LensModel::fisheye) return undistort_fisheye(q);
  // Newton's method from the distorted point converges for most lenses and pixels.
  Vector2d p = q;
  for (int i = 0; i < 20; ++i) {
    Matrix2d jacobian;
    const Vector2d residual = formula(p, &jacobian) - q;
    p -= jacobian.inverse() * residual;
    if (residual.squaredNorm() < kTolerance * kTolerance) {
      if (p.squaredNorm() <= max_radius_ * max_radius_) return p;
      break;  // a solution beyond the fold
    }
  }
  return undistort_damped(q);
}

/// Solves for the angle by Newton's method safeguarded by bisection; the radius is monotonic in it.
Vector2d LensDistortion::undistort_fisheye(const Vector2d& q) const {
  const double target = q.norm();
  if (!(target > 1e-12)) return q;
  const Vector2d direction = q / target;
  double low = 0.0;
  double high = std::atan(max_radius_);
  const double border = fisheye_radius(coefficients_, high).value;
  if (!(target < border))
    return (max_radius_ + (target - border) / extrapolation_slope_) * direction;
  double angle = std::min(target, 0.5 * high);
  for (int i = 0; i < 100; ++i) {
    const FisheyeRadius radius = fisheye_radius(coefficients_, angle);
    const double residual = radius.value - target;
    (residual > 0.0 ? high : low) = angle;
    double next = angle - residual / radius.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = std::abs(next - angle);
    angle = next;
    if (change < 1e-15) break;
  }
  return std::tan(angle) * direction;
}

/// Damped Newton's method: backtracking line search that halves each step until the residual
/// decreases. As the map is one-to-one with a non-singular Jacobian, it converges from any start.
Vector2d LensDistortion::undistort_damped(const Vector2d& q) const {
  constexpr double kMinDecrease = 1e-3;   // fraction of the linear prediction (Armijo condition)
  constexpr double kMinFraction = 1e-15;  // of a step: smaller ones are lost to rounding
  Vector2d p = Vector2d::Zero();
  Matrix2d jacobian;
  Vector2d residual = distort(p, &jacobian) - q;
  const double tolerance = kTolerance * std::max(1.0, q.norm());
  for (int i = 0; i < 200 && !(residual.norm() < tolerance); ++i) {
    const Vector2d step = jacobian.inverse() * residual;
    double fraction = 1.0;
    Vector2d next = p - step;
    const auto is_sufficient_decrease = [&] {
      return (distort(next) - q).norm() < (1.0 - kMinDecrease * fraction) * residual.norm();
    };
    while (fraction > kMinFraction && !is_sufficient_decrease()) {
      fraction *= 0.5;
      next = p - fraction * step;
    }
    if (fraction <= kMinFraction) break;  // at the rounding error
    p = next;
    residual = distort(p, &jacobian) - q;
  }
  return p;
}

}  // namespace pcavr
