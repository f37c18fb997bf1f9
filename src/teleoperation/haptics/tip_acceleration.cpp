// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/tip_acceleration.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::detail {

/// Weights of the least-squares cubic's second derivative at the newest sample.
void TipAcceleration::set_interval(double dt) noexcept {
  dt_ = dt;
  size_ = static_cast<int>(
      std::clamp(std::round(time_ / dt), double{kMinSamples}, double{kMaxSamples}));
  count_ = 0;
  next_ = 0;
  const double span = size_ - 1.0;
  const auto powers_at = [&](int i) {
    const double u = (i - span) / span;  // -1 to 0
    return Eigen::Vector4d(1.0, u, u * u, u * u * u);
  };
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (int i = 0; i < size_; ++i) normal += powers_at(i) * powers_at(i).transpose();
  const Eigen::Matrix4d inverse = normal.inverse();
  const Eigen::Vector4d second = 2.0 / std::pow(span * dt, 2) * inverse.row(2).transpose();
  for (int i = 0; i < size_; ++i) {
    weights_[static_cast<std::size_t>(i)] = second.dot(powers_at(i));
  }
}

void TipAcceleration::add(const Eigen::Vector3d& p, double dt) noexcept {
  if (dt != dt_) set_interval(dt);
  positions_[static_cast<std::size_t>(next_)] = p;
  next_ = (next_ + 1) % size_;
  count_ = std::min(count_ + 1, size_);
}

Eigen::Vector3d TipAcceleration::value() const noexcept {
  if (size_ == 0 || count_ < size_) return Eigen::Vector3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < size_; ++i) {
    // Relative to the oldest: the weights sum to zero, so that only rounding changes.
    sum += weights_[static_cast<std::size_t>(i)] *
           (positions_[static_cast<std::size_t>((next_ + i) % size_)] -
            positions_[static_cast<std::size_t>(next_)]);
  }
  const double norm = sum.norm();
  return norm > limit_ ? Eigen::Vector3d(limit_ / norm * sum) : sum;
}

}  // namespace pcavr::detail
