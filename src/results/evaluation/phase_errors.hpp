// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include "phase_timeline.hpp"

namespace pcavr {

/// Events of one kind farther apart than this do not match: a slow push goes from contact to
/// sliding within half a second [paper C, Fig. 11]. Part of the metric's definition, and named in
/// the report: no option.
inline constexpr Duration kMaxMatchDistance = std::chrono::milliseconds(500);

struct MatchedEvent {
  TimedEvent reference;
  std::optional<Stamp> estimate = {};  ///< empty: missed
};

/// One object's estimated phases against the reference's.
struct PhaseErrors {
  std::vector<MatchedEvent> events;  ///< the reference's, by time
  std::vector<TimedEvent> surplus;   ///< events of the estimate without a match (false positives)
  /// Confusion matrix: time [s] by the reference's phase (row) and the estimate's (column).
  std::array<std::array<double, kPhaseCount>, kPhaseCount> seconds{};
};

/// Errors over the time span of both; `end` is the last instant of either. Events match events of
/// their kind, nearest pairs first, within kMaxMatchDistance.
[[nodiscard]] PhaseErrors phase_errors(const PhaseTimeline& reference,
                                       const PhaseTimeline& estimate, Stamp end);

/// |time difference| [s] of the matched events, of one kind or of all.
[[nodiscard]] std::vector<double> event_errors(const PhaseErrors& errors,
                                               std::optional<PhaseEvent> kind = std::nullopt);

[[nodiscard]] std::size_t count_missed(const PhaseErrors& errors,
                                       std::optional<PhaseEvent> kind = std::nullopt);
[[nodiscard]] std::size_t count_surplus(const PhaseErrors& errors,
                                        std::optional<PhaseEvent> kind = std::nullopt);

/// Pools several objects' errors.
[[nodiscard]] PhaseErrors merged(const std::vector<PhaseErrors>& errors);

/// Share of the time in which both have the same phase; with `touched`, of the time in which either
/// has another one than free. 0 where there is no such time.
[[nodiscard]] double agreement(const PhaseErrors& errors, bool touched);

}  // namespace pcavr
