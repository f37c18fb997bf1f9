// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// A phase as in `truth/phase.csv` and a run's `phases.csv`. Separate from prediction's
/// MotionPhase, so that the evaluation depends on the files only.
enum class Phase {
  free,            ///< at rest, no contact
  static_contact,  ///< in contact, at rest: "static"
  critical,        ///< in contact, at rest, friction near its static limit
  sliding,
};
inline constexpr std::size_t kPhaseCount = 4;
inline constexpr std::array<Phase, kPhaseCount> kPhases = {Phase::free, Phase::static_contact,
                                                           Phase::critical, Phase::sliding};

/// The name in the files: "free", "static", "critical", "sliding".
[[nodiscard]] std::string_view to_string(Phase phase);
[[nodiscard]] std::optional<Phase> phase_from_string(std::string_view name);

/// A phase lasts from its stamp until the next one's.
struct PhaseChange {
  Stamp stamp;
  Phase phase = Phase::free;
};
/// One object's, by strictly ascending stamp; neighbours differ.
using PhaseTimeline = std::vector<PhaseChange>;

/// Empty before the first change.
[[nodiscard]] std::optional<Phase> phase_at(const PhaseTimeline& timeline, Stamp stamp);

/// Phase transitions; the first five are paper C's time nodes (t1 to t5, Fig. 11).
enum class PhaseEvent {
  contact,   ///< from free to contact
  critical,  ///< into critical
  sliding,   ///< into sliding
  stop,      ///< out of sliding
  leave,     ///< into free
  eased,     ///< from critical back to static
};
inline constexpr std::size_t kEventCount = 6;
inline constexpr std::array<PhaseEvent, kEventCount> kEvents = {
    PhaseEvent::contact, PhaseEvent::critical, PhaseEvent::sliding,
    PhaseEvent::stop,    PhaseEvent::leave,    PhaseEvent::eased};

[[nodiscard]] std::string_view to_string(PhaseEvent event);

struct TimedEvent {
  Stamp stamp;
  PhaseEvent event = PhaseEvent::contact;
};

/// The events at each change but the first row. One change may be two events: where contact is lost
/// while the object slides, stop and leave have the same stamp.
[[nodiscard]] std::vector<TimedEvent> events_of(const PhaseTimeline& timeline);

}  // namespace pcavr
