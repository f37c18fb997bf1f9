// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/noise_tracker.hpp"

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// Samples of a block: a second of a typical sensor, whose std is known to 4 %.
constexpr std::size_t kNoiseBlock = 512;
/// The first estimates are from this many samples, half a second of a slow sensor, and from each
/// doubling of it.
constexpr std::size_t kFirstEstimate = 16;
/// Blocks that count: a minute of a typical sensor.
constexpr std::size_t kMaxNoiseBlocks = 60;

Eigen::Vector3d block_std(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) result[axis] = estimate_noise_std(axis_of(values, axis));
  return result;
}

Eigen::Vector3d median_block(const std::deque<Eigen::Vector3d>& blocks) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& block : blocks) values.push_back(block[axis]);
    result[axis] = median(std::move(values));
  }
  return result;
}

bool is_estimate_due(std::size_t count) {
  for (std::size_t due = kFirstEstimate; due < kNoiseBlock; due *= 2) {
    if (count == due) return true;
  }
  return false;
}

}  // namespace

bool NoiseTracker::add(const Eigen::Vector3d& value) {
  block_.push_back(value);
  if (block_.size() == kNoiseBlock) {
    complete_.push_back(block_std(block_));
    if (complete_.size() > kMaxNoiseBlocks) complete_.pop_front();
    block_.clear();
    std_ = median_block(complete_);
    return true;
  }
  if (!complete_.empty() || !is_estimate_due(block_.size())) return false;
  std_ = block_std(block_);
  return true;
}

void NoiseTracker::clear() {
  block_.clear();
  complete_.clear();
  std_ = prior_;
}

}  // namespace pcavr
