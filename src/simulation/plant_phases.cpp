// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/plant_phases.hpp"

#include <algorithm>

namespace pcavr::simulation {
namespace {

// The recording format's figures.
constexpr double kStartSpeed = 0.001;  // [m/s]
constexpr double kStopSpeed = 0.0003;  // [m/s]
constexpr double kCriticalShare = 0.9;
constexpr double kMinPhase = 0.008;  // [s]

PlantPhase next_phase(PlantPhase now, const PhaseSigns& signs) {
  const double least = now == PlantPhase::sliding ? kStopSpeed : kStartSpeed;
  if (signs.speed > least) return PlantPhase::sliding;
  if (!signs.is_touched) return PlantPhase::free;
  return signs.friction_share >= kCriticalShare ? PlantPhase::critical
                                                : PlantPhase::static_friction;
}

}  // namespace

void PhaseLog::add(double t, const PhaseSigns& signs) {
  now_ = next_phase(now_, signs);
  if (!changes_.empty() && changes_.back().phase == now_) return;
  if (changes_.size() > 1 && t - changes_.back().t < kMinPhase) changes_.pop_back();
  if (changes_.empty() || changes_.back().phase != now_) {
    changes_.push_back({.t = t, .body = body_, .phase = now_});
  }
}

std::vector<PlantPhaseChange> merged(const std::vector<PhaseLog>& logs) {
  std::vector<PlantPhaseChange> all;
  for (const PhaseLog& log : logs) {
    all.insert(all.end(), log.changes().begin(), log.changes().end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const PlantPhaseChange& a, const PlantPhaseChange& b) { return a.t < b.t; });
  return all;
}

}  // namespace pcavr::simulation
