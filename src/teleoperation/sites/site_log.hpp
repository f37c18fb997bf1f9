// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/teleoperation/link/delay_stages.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"

namespace pcavr {

/// The state of the link at an operator's site [s].
struct LinkStatistics {
  double clock_offset = 0.0;  ///< shared clock less this site's
  double clock_std = 0.0;
  double round_trip = 0.0;  ///< fastest
  double delay_variation = 0.0;
  double lead = 0.0;  ///< from sending a command to its execution
};

/// Receives what the sites do and decide, from their own threads. The default does nothing. Times
/// are those of the site's clock [s].
class SiteLog {
 public:
  virtual ~SiteLog() = default;

  /// The site's clock begins.
  virtual void on_start(double /*now*/) {}
  /// A whole message, as encoded.
  virtual void on_sent(double /*now*/, std::span<const std::uint8_t>) {}
  virtual void on_received(double /*now*/, std::span<const std::uint8_t>) {}
  enum class Level : std::uint8_t { note, warning };
  virtual void on_event(double /*now*/, Level, std::string_view /*text*/) {}

  // The robot's site.
  virtual void on_session(std::uint32_t /*session*/, const std::string& /*key*/) {}
  virtual void on_executed(std::uint32_t /*session*/, const std::string& /*key*/,
                           const LinkCommand&) {}
  virtual void on_composed(std::uint32_t /*session*/, const LinkCorrection&) {}
  /// Measured at `t`.
  virtual void on_tool(double /*t*/, const RobotSamples::Tool&) {}
  virtual void on_wrench(double /*t*/, const RobotSamples::Wrench&) {}
  virtual void on_tracked(double /*t*/, const RobotSamples::Tracked&) {}
  /// A phase that was found to have begun at `t`.
  virtual void on_phase(double /*t*/, std::size_t /*object*/, MotionPhase) {}

  // The operator's site.
  virtual void on_commanded(std::uint32_t /*session*/, const LinkCommand&) {}
  virtual void on_applied(double /*now*/, std::uint32_t /*session*/, const LinkCorrection&,
                          bool /*is_valid*/) {}
  virtual void on_delays(double /*now*/, const DelayStamps&) {}
  virtual void on_link(double /*now*/, const LinkStatistics&) {}

  /// Why nothing is logged any more; once.
  [[nodiscard]] virtual std::optional<std::string> take_fault() { return std::nullopt; }
};

}  // namespace pcavr
