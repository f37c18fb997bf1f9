// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/simulation/plant.hpp"

namespace pcavr::simulation {

/// What a body's phase is told by.
struct PhaseSigns {
  double speed = 0.0;  ///< [m/s]
  bool is_touched = false;
  double friction_share = 0.0;  ///< of what friction can bear at rest
};

/// Follows the phase of one body, by the recording format's definitions.
class PhaseLog {
 public:
  explicit PhaseLog(std::size_t body) : body_(body) {}
  /// Call with ascending times [s].
  void add(double t, const PhaseSigns& signs);
  [[nodiscard]] const std::vector<PlantPhaseChange>& changes() const { return changes_; }

 private:
  std::size_t body_;
  PlantPhase now_ = PlantPhase::free;
  std::vector<PlantPhaseChange> changes_;
};

/// The changes of all bodies in the order of time.
[[nodiscard]] std::vector<PlantPhaseChange> merged(const std::vector<PhaseLog>& logs);

}  // namespace pcavr::simulation
