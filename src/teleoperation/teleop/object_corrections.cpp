// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/object_corrections.hpp"

#include <utility>

#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {

void ObjectCorrections::number(CorrectionMessage& message, double now) {
  message.sequence = ++sequence_;
  in_flight_ = InFlight{message.sequence, message.parameters};
  decision_.note_sent(message.which, now, message.sequence);
}

void ObjectCorrections::acknowledge(std::uint8_t received) {
  decision_.note_received(received);
  if (!in_flight_ || received != in_flight_->sequence) return;
  overwrite(acknowledged_, in_flight_->parameters);
  in_flight_.reset();
}

void ObjectCorrections::restart() {
  in_flight_.reset();
  decision_.restart();
  off_since_.reset();
  is_full_state_due_ = true;
}

std::optional<CorrectionCase> ObjectCorrections::take_unfinished_law() {
  return std::exchange(unfinished_law_, std::nullopt);
}

}  // namespace pcavr
