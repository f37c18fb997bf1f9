// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "physics/inputs/window.hpp"

namespace pcavr {

/// The evidence of all windows so far, in bounded memory: counts, and the newest contacts.
class AccumulatedFindings {
 public:
  /// The bodies at the start of the next window.
  explicit AccumulatedFindings(std::vector<InputBody> bodies);

  void add(const WindowFindings& window);
  [[nodiscard]] const std::vector<InputBody>& bodies() const { return bodies_; }
  [[nodiscard]] WindowPrior prior() const;
  [[nodiscard]] InputFindings conclude() const;

 private:
  [[nodiscard]] std::optional<InputFault> find_fault(const std::optional<NoContact>& none) const;
  [[nodiscard]] std::vector<std::string> notes() const;
  [[nodiscard]] std::vector<std::string> warnings() const;
  void add_delay_as_measured(InputFindings& findings) const;

  std::vector<InputBody> bodies_;
  InputFindings counts_;                           ///< counts and offsets only
  double first_outlier_ = 0.0, first_jump_ = 0.0;  ///< [s]
  double free_force_ = 0.0;                        ///< [N] maximum
  std::optional<ForceFilter> force_filter_ = {};   ///< of the newest window
  bool has_unknown_filter_ = false;                ///< the same
  std::optional<ClockDrift> force_drift_ = {};     ///< the same
  std::vector<ContactEvidence> evidence_;
  UnitTouches touches_;
  BodyPlacements placement_;
  std::optional<InputFault> clock_fault_;
  bool is_clock_sound_ = false;           ///< a window with contacts has no clock fault
  std::vector<FrictionRatios> friction_;  ///< by body
  std::vector<Approach> approaches_;      ///< by body
};

}  // namespace pcavr
