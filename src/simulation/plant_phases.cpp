// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/plant_phases.hpp"

#include <algorithm>

namespace pcavr::simulation {
namespace {

// The recording format's thresholds (docs/recording-format.md).
constexpr double kStartSpeed = 0.001;  // [m/s]
constexpr double kStopSpeed = 0.0003;  // [m/s]
constexpr double kCriticalRatio = 0.9;
constexpr double kMinPhase = 0.008;  // [s]

PlantPhase next_phase(PlantPhase now, const PhaseInputs& inputs) {
  const double threshold = now == PlantPhase::sliding ? kStopSpeed : kStartSpeed;
  if (inputs.speed > threshold) return PlantPhase::sliding;
  if (!inputs.is_touched) return PlantPhase::free;
  return inputs.friction_ratio >= kCriticalRatio ? PlantPhase::critical
                                                 : PlantPhase::static_friction;
}

}  // namespace

void PhaseRecorder::add(double t, const PhaseInputs& inputs) {
  now_ = next_phase(now_, inputs);
  if (!changes_.empty() && changes_.back().phase == now_) return;
  if (changes_.size() > 1 && t - changes_.back().t < kMinPhase) changes_.pop_back();
  if (changes_.empty() || changes_.back().phase != now_) {
    changes_.push_back({.t = t, .body = body_, .phase = now_});
  }
}

std::vector<PlantPhaseChange> merge_by_time(const std::vector<PhaseRecorder>& recorders) {
  std::vector<PlantPhaseChange> all;
  for (const PhaseRecorder& recorder : recorders) {
    all.insert(all.end(), recorder.changes().begin(), recorder.changes().end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const PlantPhaseChange& a, const PlantPhaseChange& b) { return a.t < b.t; });
  return all;
}

}  // namespace pcavr::simulation
