// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcavr/prediction/predictor.hpp"

namespace pcavr::detail {

/// What was said about the past, so that it is said again whenever that past is predicted anew.
/// Holds a bounded number; allocates only when made.
class CorrectionLog {
 public:
  /// With the physics from before the memory.
  explicit CorrectionLog(const PredictedWorld& world);

  /// A newer word on a body's physics stands for all later ones; a pose stays true for its time.
  void add(std::int64_t step, const Correction& correction) noexcept;
  /// What lies before `oldest` is no longer needed one by one.
  void forget_before(std::int64_t oldest) noexcept;

  /// Gives the world the physics that held just after `step`.
  void restore_physics(std::int64_t step, PredictedWorld& world) const noexcept;
  /// Says again what was said of `step`. `scratch` has the world's size.
  void apply(std::int64_t step, PredictedWorld& world,
             std::vector<BodyState>& scratch) const noexcept;

 private:
  struct Entry {
    std::int64_t step = 0;
    Correction said;
  };
  void forget_first() noexcept;

  std::vector<BodyPhysics> before_;  ///< by body, from before the first entry
  std::vector<Entry> entries_;       ///< by step, then as they came
};

/// Places a body as a correction says.
void apply_pose(const Correction& said, PredictedWorld& world,
                std::vector<BodyState>& scratch) noexcept;

}  // namespace pcavr::detail
