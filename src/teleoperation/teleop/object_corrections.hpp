// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "pcavr/physics/object/object_parameters.hpp"

#include "teleoperation/teleop/correction_switch.hpp"
#include "teleoperation/teleop/message.hpp"

namespace pcavr {

/// What the operator's site knows of one object, and what is on its way there. At most one
/// correction is in flight: the one with the last number; its parameters count as known there only
/// when that number has come back. Not thread-safe.
class ObjectCorrections {
 public:
  /// `acknowledged`: what the operator's site has at the start.
  ObjectCorrections(const CorrectionSwitch& decision, ObjectParameters acknowledged)
      : decision_(decision), acknowledged_(std::move(acknowledged)) {}

  /// Which case requires a correction, if any.
  [[nodiscard]] CorrectionSwitch& decision() { return decision_; }
  [[nodiscard]] const CorrectionSwitch& decision() const { return decision_; }

  /// Numbers a message that is sent at `now` [s]: it is in flight.
  void number(CorrectionMessage& message, double now);
  /// The operator's site has used the correction of that number.
  void acknowledge(std::uint8_t received);
  /// Parameters that the operator's site has confirmed.
  [[nodiscard]] const ObjectParameters& acknowledged() const { return acknowledged_; }
  /// Those that it may have; nullptr: none.
  [[nodiscard]] const ObjectParameters* in_flight() const {
    return in_flight_ ? &in_flight_->parameters : nullptr;
  }

  /// The sites were apart: nothing is in flight, and all of the object's state is to be sent.
  void restart();
  [[nodiscard]] bool is_full_state_due() const { return is_full_state_due_; }
  void note_full_state() { is_full_state_due_ = false; }

  /// The tool is kept off the object [paper C, case 2] from `t` [s] on, until it is released.
  void keep_off(double t) { off_since_ = t; }
  void release() { off_since_.reset(); }
  [[nodiscard]] std::optional<double> off_since() const { return off_since_; }

  /// That case was found in a contact that had not ended, and a contact law was sent, or none is
  /// known: the whole contact may show a better one, which no error would ask for until the next.
  void note_unfinished_law(CorrectionCase which) { unfinished_law_ = which; }
  [[nodiscard]] std::optional<CorrectionCase> take_unfinished_law();

 private:
  struct InFlight {
    std::uint8_t sequence = 0;
    ObjectParameters parameters;
  };

  CorrectionSwitch decision_;
  ObjectParameters acknowledged_;
  std::optional<InFlight> in_flight_ = {};
  std::uint8_t sequence_ = 0;  ///< the last
  bool is_full_state_due_ = false;
  std::optional<double> off_since_ = {};  ///< [s]
  std::optional<CorrectionCase> unfinished_law_ = {};
};

}  // namespace pcavr
