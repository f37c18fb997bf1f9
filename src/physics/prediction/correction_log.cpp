// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/correction_log.hpp"

#include <algorithm>

namespace pcavr::detail {

CorrectionLog::CorrectionLog(const PredictedWorld& world, std::size_t max_entries)
    : max_entries_(max_entries) {
  for (std::size_t i = 0; i < world.size(); ++i) before_.push_back(world.physics(i));
  entries_.reserve(max_entries);
}

void CorrectionLog::add(std::int64_t step, const Correction& correction) noexcept {
  if (entries_.size() == max_entries_) discard_first();
  const auto after =
      std::upper_bound(entries_.begin(), entries_.end(), step,
                       [](std::int64_t at, const Entry& entry) { return at < entry.step; });
  const auto inserted = entries_.insert(after, Entry{step, correction});
  if (!correction.physics) return;
  for (auto later = inserted + 1; later != entries_.end(); ++later) {
    if (later->correction.body == correction.body) later->correction.physics.reset();
  }
}

void CorrectionLog::discard_first() noexcept {
  const Correction& correction = entries_.front().correction;
  if (correction.physics) before_[correction.body] = *correction.physics;
  entries_.erase(entries_.begin());
}

void CorrectionLog::discard_before(std::int64_t oldest) noexcept {
  while (!entries_.empty() && entries_.front().step < oldest) discard_first();
}

void CorrectionLog::restore_physics(std::int64_t step, PredictedWorld& world) const noexcept {
  for (std::size_t body = 0; body < before_.size(); ++body) {
    const BodyPhysics* physics = &before_[body];
    for (const Entry& entry : entries_) {
      if (entry.step > step) break;
      if (entry.correction.body == body && entry.correction.physics)
        physics = &*entry.correction.physics;
    }
    world.set_physics(body, *physics);
  }
}

void CorrectionLog::apply(std::int64_t step, PredictedWorld& world,
                          std::vector<BodyState>& scratch) const noexcept {
  auto entry = std::lower_bound(entries_.begin(), entries_.end(), step,
                                [](const Entry& e, std::int64_t at) { return e.step < at; });
  for (; entry != entries_.end() && entry->step == step; ++entry) {
    if (entry->correction.physics)
      world.set_physics(entry->correction.body, *entry->correction.physics);
    apply_pose(entry->correction, world, scratch);
  }
}

void apply_pose(const Correction& correction, PredictedWorld& world,
                std::vector<BodyState>& scratch) noexcept {
  if (!correction.T_base_object && !correction.twist) return;
  const PlanarState before = world.state()[correction.body].planar;
  if (correction.T_base_object) world.set_pose(correction.body, *correction.T_base_object);
  std::copy(world.state().begin(), world.state().end(), scratch.begin());
  PlanarState& planar = scratch[correction.body].planar;
  planar.twist = correction.twist.value_or(before.twist);
  if (planar.twist.isZero(0.0)) {
    planar.phase = before.twist.isZero(0.0) ? before.phase : FrictionPhase::static_contact;
  } else {
    planar.phase = FrictionPhase::sliding;
  }
  world.set_state(scratch);
}

}  // namespace pcavr::detail
