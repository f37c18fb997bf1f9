// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcavr/evaluation/trajectory_errors.hpp"

#include "phase_timeline.hpp"

namespace pcavr {

/// An estimated event further than this from every true one of its kind is another event: a slow
/// push passes from contact to sliding within half a second [paper C, Fig. 11].
inline constexpr Duration kFarthestEvent = std::chrono::milliseconds(500);

struct MatchedEvent {
  TimedEvent reference;
  std::optional<Stamp> estimate = {};  ///< nothing: missed
};

/// One object's estimated phases against the reference's.
struct PhaseErrors {
  std::vector<MatchedEvent> events;  ///< the reference's, by time
  std::vector<TimedEvent> surplus;   ///< the estimate's that are no event of the reference
  /// Time [s] by the reference's phase (row) and the estimate's (column).
  std::array<std::array<double, kPhaseCount>, kPhaseCount> seconds{};
};

/// Over the span in which both are known; `end` is the last instant of either. Events match with
/// those of their kind, nearest pairs first, within kFarthestEvent.
[[nodiscard]] PhaseErrors phase_errors(const PhaseTimeline& reference,
                                       const PhaseTimeline& estimate, Stamp end);

/// |time difference| [s] of the events that have a match, of one kind or of all.
[[nodiscard]] std::vector<double> event_errors(const PhaseErrors& errors,
                                               std::optional<PhaseEvent> kind = std::nullopt);

[[nodiscard]] std::size_t count_missed(const PhaseErrors& errors,
                                       std::optional<PhaseEvent> kind = std::nullopt);
[[nodiscard]] std::size_t count_surplus(const PhaseErrors& errors,
                                        std::optional<PhaseEvent> kind = std::nullopt);

/// Several objects' errors as one list.
[[nodiscard]] PhaseErrors together(const std::vector<PhaseErrors>& errors);

/// Share of the time in which both say the same; with `touched`, of the time in which either says
/// other than free. 0 where there is no such time.
[[nodiscard]] double agreement(const PhaseErrors& errors, bool touched);

}  // namespace pcavr
