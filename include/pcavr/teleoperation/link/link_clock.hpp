// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

namespace pcavr {

/// The clock of the other site, by round trips: offset and drift with their uncertainty. Only the
/// fastest round trip of each second counts (the minimum-delay filter of NTP [RFC 5905, section
/// 10]); a weighted regression over a minute of them gives offset and drift. Clocks that are far
/// apart, and steps of either, are permitted. Not thread-safe.
class LinkClock {
 public:
  /// Times of one ping and its pong [s]: `sent` and `returned` on this site's clock, the others on
  /// the other site's, which is the shared one.
  struct RoundTrip {
    double sent = 0.0;
    double received = 0.0;
    double replied = 0.0;
    double returned = 0.0;
    [[nodiscard]] double delay() const { return (returned - sent) - (replied - received); }
    [[nodiscard]] double offset() const { return 0.5 * ((received - sent) + (replied - returned)); }
  };

  /// A round trip with a negative delay, or with a number that is not finite, is ignored; so is one
  /// that was delayed much longer than the others, for a second.
  void add(const RoundTrip& trip);

  [[nodiscard]] bool is_known() const { return !fastest_.empty(); }
  /// The shared clock at this site's clock `local`, and the reverse [s]; require is_known().
  [[nodiscard]] double shared_at(double local) const;
  [[nodiscard]] double local_at(double shared) const;

  [[nodiscard]] double drift() const { return drift_; }  ///< of the shared clock against this one
  /// Standard deviation of shared_at() now, without the asymmetry of the two directions [s].
  [[nodiscard]] double std() const { return std_; }
  /// Half the fastest round trip: no round trip can show an asymmetry of the two directions, which
  /// shifts the clock by at most this [s].
  [[nodiscard]] double max_asymmetry() const { return 0.5 * min_delay_; }
  [[nodiscard]] double min_delay() const { return min_delay_; }  ///< fastest round trip [s]
  /// Exponential means of the round trip and of its absolute variation [s], as in RFC 6298.
  [[nodiscard]] double mean_delay() const { return mean_delay_; }
  [[nodiscard]] double delay_variation() const { return delay_variation_; }
  [[nodiscard]] int steps() const { return steps_; }  ///< of either clock, noticed so far

 private:
  [[nodiscard]] bool contradicts(const RoundTrip& trip) const;
  [[nodiscard]] bool is_stalled(const RoundTrip& trip);
  void restart();
  void keep(const RoundTrip& trip);
  void estimate();

  std::deque<RoundTrip> fastest_;  ///< of each second
  std::deque<RoundTrip> contradicting_;
  std::optional<double> stalled_since_ = {};  ///< [s] of this site's clock
  double reference_ = 0.0;  ///< [s] of this site's clock, at which `offset_` holds
  double offset_ = 0.0;
  double drift_ = 0.0;
  double std_ = 0.0;
  double min_delay_ = 0.0;
  double mean_delay_ = 0.0;
  double delay_variation_ = 0.0;
  int steps_ = 0;
};

}  // namespace pcavr
