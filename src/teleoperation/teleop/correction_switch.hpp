// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "pcavr/teleoperation/teleop/options.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// One object's state at one time: measured by the robot's site, and as the operator's site had
/// predicted it.
struct SiteComparison {
  double t = 0.0;
  bool robot_slides = false, operator_slides = false;
  bool robot_touches = false, operator_touches = false;
  double robot_force = 0.0, operator_force = 0.0;  ///< along the push [N]
  std::optional<double> position_gap = {};         ///< [m] position error; if known at t
  double push_gap = 0.0;      ///< [m] its part along the push; signed, only with position_gap
  double position_std = 0.0;  ///< of the robot's pose estimate [m]
};

/// The correction switch of one object [paper C; methods of section 5]: decides which case, if any,
/// requires a correction now.
///
/// Adaptive thresholds. Position: some standard deviations of the robot's pose estimate, at least
/// `min_position_error`, times a backoff factor as the traffic exceeds its budget, at most
/// `position_tolerance`. Force: a share of the real one, at least `force_floor`, times the same
/// factor. Debouncing: a difference counts after a time longer than the two sites' phase stamps may
/// differ. While a correction is in flight (a round trip and a margin), the same case is not sent
/// again unless the error has grown.
///
/// While both slide, tip and penetration put the object where it is, so that a wrong sliding
/// friction shows in the force only. Paper C finds case 1.3 by the position; here a wrong force
/// alone is of that case, too: parameters correct it, not a position.
class CorrectionSwitch {
 public:
  /// `force_floor` [N]: minimum difference of forces, the sensor's noise and drift. `round_trip`:
  /// [s].
  CorrectionSwitch(const CorrectionSwitchOptions& options, double force_floor, double round_trip)
      : options_(options), force_floor_(force_floor), round_trip_(round_trip) {}

  void set_force_floor(double force_floor) { force_floor_ = force_floor; }
  /// Nothing was sent, and nothing found yet.
  void restart() { *this = CorrectionSwitch(options_, force_floor_, round_trip_); }
  /// `traffic`: bytes sent so far over the byte budget (rate limit). Call in ascending order of
  /// time.
  [[nodiscard]] std::optional<CorrectionCase> evaluate(const SiteComparison& seen, double traffic);
  /// Whether both slide and the force differs in the case that `evaluate` has found last.
  [[nodiscard]] bool is_sliding_force() const { return is_sliding_force_; }
  /// Whether the forces differ by no more than the tolerance: as in case 1.3 of paper C.
  [[nodiscard]] bool forces_agree(const SiteComparison& seen) const;
  /// Case 1.3 only: a correction was received in this slide, right after that the error along the
  /// push was still more than half of the error before, and it has not grown since. Along the push
  /// an object is where the tip and its penetration put it, so that the contact undoes a corrected
  /// position within milliseconds: only other parameters change that.
  [[nodiscard]] bool had_no_effect(CorrectionCase which) const;
  void set_round_trip(double round_trip) { round_trip_ = round_trip; }  ///< [s]
  /// A correction of that case was sent at `t_sent` [s].
  void note_sent(CorrectionCase which, double t_sent, std::uint8_t sequence = 0);
  /// The operator's site has received the correction of that number.
  void note_received(std::uint8_t sequence);
  /// Corrections in flight do not hold back the next one: there is more to send than they contain.
  void send_again();
  /// There was nothing new to send for that case: it is suppressed for a tenth of a second.
  void note_nothing_to_send(CorrectionCase which, double t);

 private:
  struct Finding {
    CorrectionCase which;
    double size;         ///< over its threshold: > 1
    double persistence;  ///< [s]
  };
  [[nodiscard]] std::optional<Finding> find(const SiteComparison& seen, double factor) const;
  [[nodiscard]] std::optional<Finding> find_sliding_force(const SiteComparison& seen,
                                                          double factor) const;

  /// One case: how long it has persisted, with short lapses ignored; and what was sent.
  struct PendingFinding {
    double since = 0.0;
    double last = -std::numeric_limits<double>::infinity();
    double size = 0.0;
    double in_flight_until = -std::numeric_limits<double>::infinity();
    double suppressed_until = -std::numeric_limits<double>::infinity();
    double size_sent = 0.0;
  };

  /// Effect of the last correction of case 1.3 in this slide.
  struct SlideEffect {
    std::optional<std::uint8_t> awaited = {};  ///< its number, until received
    bool is_received = false;
    std::optional<double> received = {};  ///< [s] first comparison since
    double gap_sent = 0.0;                ///< [m]
    double sum_after = 0.0;  ///< [m] of the gaps along the push right after it was received
    int count_after = 0;
  };
  void observe_effect(const SiteComparison& seen);
  /// Whether a finding has persisted, and no correction of it is on its way.
  [[nodiscard]] bool is_due(const Finding& finding, double t, PendingFinding& pending) const;
  /// The last finding of `evaluate` for that case.
  [[nodiscard]] PendingFinding& pending_of(CorrectionCase which) {
    return is_sliding_force_ ? sliding_force_ : pending_[static_cast<std::size_t>(which)];
  }

  CorrectionSwitchOptions options_;
  double force_floor_;
  double round_trip_;
  std::array<PendingFinding, 5> pending_{};
  PendingFinding sliding_force_;
  bool is_sliding_force_ = false;
  SlideEffect effect_;
  double gap_ = 0.0;  ///< [m] the newest
};

}  // namespace pcavr
