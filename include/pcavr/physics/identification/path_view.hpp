// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace pcavr {

/// A trajectory of points, times strictly ascending: linear interpolation between samples, constant
/// beyond the ends. A view: the series must outlive it, and must not be empty when it is read.
class PathView {
 public:
  PathView(std::span<const double> t, std::span<const Eigen::Vector3d> points)
      : t_(t), points_(points) {}
  [[nodiscard]] Eigen::Vector3d at(double t) const;
  /// The same for times that ascend from call to call, without a search: `next` is 0 at first, and
  /// then the first sample that is not before `t`.
  [[nodiscard]] Eigen::Vector3d at(double t, std::size_t& next) const;
  [[nodiscard]] std::span<const double> t() const { return t_; }

 private:
  /// `after` is the first sample that is not before `t`.
  [[nodiscard]] Eigen::Vector3d before(std::size_t after, double t) const;

  std::span<const double> t_;
  std::span<const Eigen::Vector3d> points_;
};

}  // namespace pcavr
