// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "pcavr/core/stamp.hpp"

namespace pcavr {

/// As `truth/phase.csv` and a run's `phases.csv` have them. A type of its own: what is judged here
/// is a file, not the code that wrote it.
enum class Phase {
  free,      ///< at rest, not touched
  held,      ///< touched and at rest: "static"
  critical,  ///< touched, at rest, friction near its limit
  sliding,
};
inline constexpr std::size_t kPhaseCount = 4;
inline constexpr std::array<Phase, kPhaseCount> kPhases = {Phase::free, Phase::held,
                                                           Phase::critical, Phase::sliding};

/// The word in the files: "free", "static", "critical", "sliding".
[[nodiscard]] std::string_view word_of(Phase phase);
[[nodiscard]] std::optional<Phase> phase_named(std::string_view word);

/// A phase holds from its stamp until the next one's.
struct PhaseChange {
  Stamp stamp;
  Phase phase = Phase::free;
};
/// One object's, by strictly ascending stamp; neighbours differ.
using PhaseTimeline = std::vector<PhaseChange>;

/// Nothing before the first change.
[[nodiscard]] std::optional<Phase> phase_at(const PhaseTimeline& timeline, Stamp stamp);

/// Borders between phases, by what happens there; the first five are paper C's time nodes (t1 to
/// t5, Fig. 11).
enum class PhaseEvent {
  contact,   ///< from free to touched
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

[[nodiscard]] std::string_view word_of(PhaseEvent event);

struct TimedEvent {
  Stamp stamp;
  PhaseEvent event = PhaseEvent::contact;
};

/// What happens at each change but the first row. One change may be two events: an object that is
/// let go while it slides, and comes to rest untouched, stops and is left at once.
[[nodiscard]] std::vector<TimedEvent> events_of(const PhaseTimeline& timeline);

}  // namespace pcavr
