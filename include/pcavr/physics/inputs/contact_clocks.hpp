// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pcavr/physics/identification/contact.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/input_options.hpp"
#include "pcavr/physics/inputs/input_series.hpp"

namespace pcavr {

/// Delay of a stream's stamps against the tool's, by one contact.
struct ContactDelay {
  double t = 0.0;      ///< [s] middle of the contact
  double delay = 0.0;  ///< [s]
  double std = 0.0;    ///< [s]
};

/// A delay that is another one from a time between two contacts on: a clock was set.
struct DelayStep {
  double after = 0.0, before = 0.0;  ///< [s] the contacts between which it was
  double size = 0.0, std = 0.0;      ///< [s] by which the delay is larger from then on
};

/// A delay that grows: a clock that is fast, or slow.
struct DelayDrift {
  double rate = 0.0, std = 0.0;  ///< [s/s]
};

/// How a stream's delay changes from contact to contact: by a step, a drift, or not at all; of both
/// the one that explains more. Empty where neither is significant.
struct DelayChange {
  std::optional<DelayStep> step = {};
  std::optional<DelayDrift> drift = {};
  double min_step = 0.0;  ///< [s] a smaller one would not show
};
/// By a weighted line; nothing of fewer than four contacts.
[[nodiscard]] std::optional<DelayDrift> fit_delay_drift(std::span<const ContactDelay> delays);
[[nodiscard]] DelayChange find_delay_change(std::span<const ContactDelay> delays);

/// Delay of one body's tracking, which may have a clock of its own.
struct TrackDelays {
  std::size_t body = 0;
  TimeOffset offset = {};       ///< by all contacts with the body
  bool may_be_shifted = false;  ///< the offset is not known: poses that are off explain as much
  std::vector<ContactDelay> contacts = {};
};

/// Delays of the force, contact by contact, and of the tracking of each body that was pushed.
struct ContactDelays {
  std::vector<ContactDelay> force = {};
  std::vector<TrackDelays> tracks = {};
};
/// `contacts`: those of examine_inputs, with their objects.
[[nodiscard]] ContactDelays contact_delays(const InputSeries& series,
                                           std::span<const Contact> contacts,
                                           const InputOptions& options);

}  // namespace pcavr
