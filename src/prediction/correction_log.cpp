// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/correction_log.hpp"

#include <algorithm>

namespace pcavr::detail {
namespace {

/// Two seconds of corrections at 60 Hz for four bodies.
constexpr std::size_t kMaxEntries = 512;

}  // namespace

CorrectionLog::CorrectionLog(const PredictedWorld& world) {
  for (std::size_t i = 0; i < world.size(); ++i) before_.push_back(world.physics(i));
  entries_.reserve(kMaxEntries);
}

void CorrectionLog::add(std::int64_t step, const Correction& correction) noexcept {
  if (entries_.size() == kMaxEntries) forget_first();
  const auto after =
      std::upper_bound(entries_.begin(), entries_.end(), step,
                       [](std::int64_t at, const Entry& entry) { return at < entry.step; });
  const auto place = entries_.insert(after, Entry{step, correction});
  if (!correction.physics) return;
  for (auto later = place + 1; later != entries_.end(); ++later) {
    if (later->said.body == correction.body) later->said.physics.reset();
  }
}

void CorrectionLog::forget_first() noexcept {
  const Correction& said = entries_.front().said;
  if (said.physics) before_[said.body] = *said.physics;
  entries_.erase(entries_.begin());
}

void CorrectionLog::forget_before(std::int64_t oldest) noexcept {
  while (!entries_.empty() && entries_.front().step < oldest) forget_first();
}

void CorrectionLog::restore_physics(std::int64_t step, PredictedWorld& world) const noexcept {
  for (std::size_t body = 0; body < before_.size(); ++body) {
    const BodyPhysics* physics = &before_[body];
    for (const Entry& entry : entries_) {
      if (entry.step > step) break;
      if (entry.said.body == body && entry.said.physics) physics = &*entry.said.physics;
    }
    world.set_physics(body, *physics);
  }
}

void CorrectionLog::apply(std::int64_t step, PredictedWorld& world,
                          std::vector<BodyState>& scratch) const noexcept {
  auto entry = std::lower_bound(entries_.begin(), entries_.end(), step,
                                [](const Entry& e, std::int64_t at) { return e.step < at; });
  for (; entry != entries_.end() && entry->step == step; ++entry) {
    if (entry->said.physics) world.set_physics(entry->said.body, *entry->said.physics);
    apply_pose(entry->said, world, scratch);
  }
}

void apply_pose(const Correction& said, PredictedWorld& world,
                std::vector<BodyState>& scratch) noexcept {
  if (!said.T_base_object && !said.twist) return;
  const PlanarState before = world.state()[said.body].planar;
  if (said.T_base_object) world.set_pose(said.body, *said.T_base_object);
  std::copy(world.state().begin(), world.state().end(), scratch.begin());
  PlanarState& planar = scratch[said.body].planar;
  planar.twist = said.twist.value_or(before.twist);
  if (planar.twist.isZero(0.0)) {
    planar.phase = before.twist.isZero(0.0) ? before.phase : FrictionPhase::held;
  } else {
    planar.phase = FrictionPhase::sliding;
  }
  world.set_state(scratch);
}

}  // namespace pcavr::detail
