// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/physics/prediction/predictor.hpp"

namespace pcavr::detail {

/// Corrections of the past, to be re-applied in every re-simulation. Bounded in number; allocates
/// only in the constructor.
class CorrectionLog {
 public:
  /// Starts with the world's present physics. At least one entry.
  CorrectionLog(const PredictedWorld& world, std::size_t max_entries);

  /// A newer correction of a body's physics replaces those of all later times; one of a pose stays
  /// valid for its time.
  void add(std::int64_t step, const Correction& correction) noexcept;
  /// Merges corrections before `oldest` into the initial physics.
  void discard_before(std::int64_t oldest) noexcept;

  /// Gives the world the physics that was valid just after `step`.
  void restore_physics(std::int64_t step, PredictedWorld& world) const noexcept;
  /// Re-applies the corrections of `step`. `scratch` has the world's size.
  void apply(std::int64_t step, PredictedWorld& world,
             std::vector<BodyState>& scratch) const noexcept;

 private:
  struct Entry {
    std::int64_t step = 0;
    Correction correction;
  };
  void discard_first() noexcept;

  std::size_t max_entries_;
  std::vector<BodyPhysics> before_;  ///< by body, from before the first entry
  std::vector<Entry> entries_;       ///< by step, then by arrival
};

/// Sets a body's pose and twist from a correction.
void apply_pose(const Correction& correction, PredictedWorld& world,
                std::vector<BodyState>& scratch) noexcept;

}  // namespace pcavr::detail
