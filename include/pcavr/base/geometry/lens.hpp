// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include <Eigen/Core>

namespace pcavr {

/// The lens distortion models that calibration tools write, with x, y on the plane z = 1 and
/// r^2 = x^2 + y^2:
/// * plumb_bob: k1 k2 p1 p2 k3 [Brown 1966]; OpenCV's five coefficients, ROS's plumb_bob;
/// * rational: k1 k2 p1 p2 k3 k4 k5 k6, the radial factor divided by 1 + k4 r^2 + k5 r^4 + k6 r^6
///   [Claus & Fitzgibbon 2005]; OpenCV's eight coefficients, ROS's rational_polynomial;
/// * fisheye: k1 k2 k3 k4, a polynomial of the angle to the optical axis [Kannala & Brandt 2006];
///   OpenCV's fisheye module, ROS's equidistant.
enum class LensModel { plumb_bob, rational, fisheye };

/// Number of coefficients of a model.
[[nodiscard]] std::size_t coefficient_count(LensModel model);
/// Their names in order, such as "k1 k2 p1 p2 k3".
[[nodiscard]] std::string_view coefficient_names(LensModel model);

/// Lens distortion of normalized image coordinates (points on the plane z = 1).
///
/// The models are not invertible everywhere: they fold (are not monotonic) beyond some radius,
/// where two rays project to the same pixel. Beyond `max_radius` the map is extrapolated linearly
/// outward instead, so that it is one-to-one everywhere, and nothing outside the field of view
/// projects into the image. A value type.
class LensDistortion {
 public:
  /// No distortion.
  LensDistortion() = default;
  /// The plumb_bob model. Implicit: `camera.distortion = {k1, k2, p1, p2, k3}`.
  LensDistortion(double k1, double k2, double p1, double p2, double k3);
  /// Throws ContractError unless there are coefficient_count(model) of them.
  LensDistortion(LensModel model, std::span<const double> coefficients);

  [[nodiscard]] LensModel model() const { return model_; }
  [[nodiscard]] std::span<const double> coefficients() const;
  /// Whether the map is the identity; false for every fisheye.
  [[nodiscard]] bool is_none() const { return is_none_; }

  /// The largest radius on the plane z = 1. Beyond it the model is not invertible, or the ray is
  /// more than 85 degrees from the optical axis, where z-depth is ill-conditioned.
  [[nodiscard]] double max_radius() const { return max_radius_; }
  /// Whether max_radius() is where the model folds (stops being monotonic); else it is the angle.
  [[nodiscard]] bool folds() const { return folds_; }

  /// The distorted coordinates of a point of the plane z = 1, and the Jacobian unless null.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& p,
                                        Eigen::Matrix2d* jacobian = nullptr) const;
  /// The inverse of distort(), to 1e-12 (relative to |q| where |q| > 1).
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& q) const;

  friend bool operator==(const LensDistortion& a, const LensDistortion& b) {
    return a.model_ == b.model_ && a.coefficients_ == b.coefficients_;
  }

 private:
  void find_max_radius();
  [[nodiscard]] Eigen::Vector2d formula(const Eigen::Vector2d& p, Eigen::Matrix2d* jacobian) const;
  [[nodiscard]] Eigen::Vector2d extrapolate(const Eigen::Vector2d& p,
                                            Eigen::Matrix2d* jacobian) const;
  [[nodiscard]] Eigen::Vector2d undistort_fisheye(const Eigen::Vector2d& q) const;
  [[nodiscard]] Eigen::Vector2d undistort_damped(const Eigen::Vector2d& q) const;

  LensModel model_ = LensModel::plumb_bob;
  bool is_none_ = true;
  bool folds_ = false;
  double max_radius_ = 0.0;           ///< this and the next: unused without distortion
  double extrapolation_slope_ = 1.0;  ///< d(distorted radius)/d(radius)
  std::array<double, 8> coefficients_{};
};

}  // namespace pcavr
