// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "task_estimates.hpp"

namespace pcavr {
namespace {

struct LinearCost {
  double constant = 0.0;
  double per_frame = 0.0;
  double per_sample = 0.0;

  [[nodiscard]] double of(std::size_t frames, std::size_t samples) const {
    return constant + per_frame * static_cast<double>(frames) +
           per_sample * static_cast<double>(samples);
  }
};

struct StageCost {
  LinearCost seconds;  ///< of one core
  LinearCost memory;   ///< [bytes]
};

/// Constants and the costs of samples are measured with one thread; docs/files.md has the
/// recordings and the machine. Those of images are upper estimates, not measured.
StageCost cost_of(TaskStage stage) {
  switch (stage) {
    case TaskStage::survey:
    case TaskStage::fuse:
    case TaskStage::build:
      return {{0.75, 0.2, 0.0}, {128e6, 2e6, 100.0}};
    case TaskStage::identify:
    case TaskStage::pool:
      return {{0.5, 0.1, 6e-6}, {77e6, 1e6, 130.0}};
    case TaskStage::replay:
      return {{0.95, 0.1, 1.5e-4}, {79e6, 1e6, 600.0}};
    case TaskStage::evaluate:
      return {{0.4, 0.0, 2e-5}, {77e6, 0.0, 700.0}};
  }
  return {};
}

}  // namespace

TaskEstimate estimate_task(TaskStage stage, std::size_t frames, std::size_t samples) {
  const StageCost cost = cost_of(stage);
  return {cost.seconds.of(frames, samples), cost.memory.of(frames, samples)};
}

}  // namespace pcavr
