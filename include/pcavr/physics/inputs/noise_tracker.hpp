// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// The std of the white noise on a stream of vectors, by axis, estimated on the way: from blocks of
/// samples by `estimate_noise_std`, of which the median over the newest ones counts, so that a
/// block in which the tool vibrates does not. Known from a first few samples on, and refined. Not
/// thread-safe.
class NoiseTracker {
 public:
  /// `prior`: until enough samples have come, of every axis.
  explicit NoiseTracker(double prior)
      : std_(Eigen::Vector3d::Constant(prior)), prior_(Eigen::Vector3d::Constant(prior)) {}

  /// True if the estimate has changed.
  bool add(const Eigen::Vector3d& value);
  [[nodiscard]] const Eigen::Vector3d& std() const { return std_; }
  [[nodiscard]] double largest() const { return std_.maxCoeff(); }
  /// Back to the prior.
  void clear();

 private:
  std::vector<Eigen::Vector3d> block_;    ///< the samples that no complete block has
  std::deque<Eigen::Vector3d> complete_;  ///< the newest blocks' results
  Eigen::Vector3d std_;
  Eigen::Vector3d prior_;
};

}  // namespace pcavr
