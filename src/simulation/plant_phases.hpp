// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/simulation/plant.hpp"

namespace pcavr::simulation {

/// Quantities that determine a body's phase.
struct PhaseInputs {
  double speed = 0.0;  ///< [m/s]
  bool is_touched = false;
  double friction_ratio = 0.0;  ///< over the limiting static friction
};

/// State machine of one body's phase, by the recording format's definitions.
class PhaseRecorder {
 public:
  explicit PhaseRecorder(std::size_t body) : body_(body) {}
  /// Call with ascending times [s].
  void add(double t, const PhaseInputs& inputs);
  [[nodiscard]] const std::vector<PlantPhaseChange>& changes() const { return changes_; }

 private:
  std::size_t body_;
  PlantPhase now_ = PlantPhase::free;
  std::vector<PlantPhaseChange> changes_;
};

/// The changes of all bodies in ascending time.
[[nodiscard]] std::vector<PlantPhaseChange> merge_by_time(
    const std::vector<PhaseRecorder>& recorders);

}  // namespace pcavr::simulation
