// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>

namespace pcavr {

/// When one command passed each stage, and its effect came back. [s] on one clock, that of the
/// operator's site, but for `device_clock`. The page adds the eighth: when it was drawn.
struct DelayStamps {
  /// Time of the hand's motion that the command shows, on the clock of the operator's device.
  std::optional<double> device_clock = {};
  double sent = 0.0;           ///< by the operator's site
  double received = 0.0;       ///< by the robot's site
  double applied = 0.0;        ///< the robot's setpoint
  double sensed = 0.0;         ///< the newest sample that the state contains
  double sent_back = 0.0;      ///< the state
  double received_back = 0.0;  ///< by the operator's site
};

/// Means of the stages' durations [s].
class DelayMeans {
 public:
  void add(const DelayStamps& stamps);
  [[nodiscard]] std::size_t count() const { return count_; }
  struct Stage {
    std::string_view name;
    double mean = 0.0;  ///< [s]
  };
  /// The stages in order; their sum is the mean from `sent` to `received_back`.
  [[nodiscard]] std::array<Stage, 5> stages() const;

 private:
  std::array<double, 5> sums_{};
  std::size_t count_ = 0;
};

/// Remembers when commands were sent, until a state names them. Not thread-safe.
class SentCommands {
 public:
  /// `t` [s] ascends: the time of execution.
  void add(double t, double sent, std::optional<double> device_clock);
  struct Sent {
    double t = 0.0;
    double sent = 0.0;  ///< [s] local clock
    std::optional<double> device_clock = {};
  };
  /// The command that is executed at `t`; forgets older ones.
  [[nodiscard]] std::optional<Sent> find(double t);
  void clear() { sent_.clear(); }

 private:
  std::deque<Sent> sent_;
};

}  // namespace pcavr
