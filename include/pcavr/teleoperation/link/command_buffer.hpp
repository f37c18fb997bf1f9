// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Conditions under which the robot's site executes a command, and under which it holds
/// ("robot_site.link").
struct CommandOptions {
  CommandOptions();
  double max_age;   ///< [s] after its time of execution, until which a command is executed
  double max_lead;  ///< [s] before its time of execution, until which it is accepted
  double timeout;   ///< [s] without a message of the other site, after which the site holds
};
[[nodiscard]] OptionSection section_of(CommandOptions& options);

/// Commands that wait for their time of execution (a jitter buffer). Stale, superseded and repeated
/// ones are discarded. Memory is bounded by max_lead and the shortest cycle. Not thread-safe.
class CommandBuffer {
 public:
  explicit CommandBuffer(const CommandOptions& options) : options_(options) {}

  /// False if it is discarded. `now` [s] of the shared clock.
  bool add(LinkCommand command, double now);
  /// Commands whose time has come, in order; the last is the one to be executed now.
  [[nodiscard]] std::vector<LinkCommand> take_due(double now);
  /// Wanted position of the tip at `now` [s]: between the last executed command and the next one
  /// that waits, also if others between them were lost. Nothing if none waits, or the clutch is
  /// open in one of them.
  [[nodiscard]] std::optional<Eigen::Vector3d> p_base_at(double now) const;
  /// Call it after an interruption: what waits is stale.
  void clear() { waiting_.clear(); }

  /// [s] When the last one of take_due() arrived.
  [[nodiscard]] double last_arrival() const { return last_arrival_; }
  [[nodiscard]] std::uint32_t discarded() const { return discarded_; }
  /// Smallest time from arrival to execution since the last call [s]; negative: late.
  [[nodiscard]] std::optional<double> take_min_lead() { return std::exchange(min_lead_, {}); }

 private:
  static constexpr double kMinCycle = 2e-4;  ///< [s] between two commands

  CommandOptions options_;
  struct Waiting {
    LinkCommand command;
    double arrival = 0.0;  ///< [s]
  };
  std::map<double, Waiting> waiting_;  ///< by time of execution
  double last_arrival_ = 0.0;
  std::optional<double> executed_ = {};
  std::optional<Eigen::Vector3f> p_base_executed_ = {};  ///< unless the clutch is open
  std::optional<double> min_lead_ = {};
  std::uint32_t discarded_ = 0;
};

}  // namespace pcavr
