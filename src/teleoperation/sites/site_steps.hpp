// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pcavr/teleoperation/link/site_transport.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/prediction_sink.hpp"

#include "site_log.hpp"

namespace pcavr {

/// Services that a site's loop takes from its machine. The defaults are the real ones; with others
/// the same loop runs in virtual time, and a run can be reproduced.
struct SiteRuntime {
  std::function<double()> clock = {};               ///< [s]; none: see SiteClock
  std::function<std::uint32_t()> new_session = {};  ///< never 0; none: by the system's entropy
  bool prepares_at_once = false;  ///< worlds are made within a step, not by a thread
  SiteLog* log = nullptr;
  PredictionSink* predictions = nullptr;
};

/// A site's main loop, one event at a time. One thread at a time.
template <typename Report>
class SiteSteps {
 public:
  virtual ~SiteSteps() = default;
  /// [s] of the runtime's clock until the next event but messages; not positive: now.
  [[nodiscard]] virtual double until_due() const = 0;
  /// Receives what has arrived, and does what is due.
  virtual void step() = 0;
  [[nodiscard]] virtual bool is_finished() const = 0;
  /// Says good-bye to the other site. Not called if the process was killed.
  [[nodiscard]] virtual Expected<Report> finish() = 0;
};

/// The references are kept. The first event is due one cycle after the call.
[[nodiscard]] std::unique_ptr<SiteSteps<RobotSiteReport>> make_robot_site_steps(
    RobotTransport& server, RobotInterface& robot, LiveRobotSite& site, const SiteScene& scene,
    const RobotSiteOptions& options, const Observer& observer, const SiteRuntime& runtime);

[[nodiscard]] std::unique_ptr<SiteSteps<OperatorSiteReport>> make_operator_site_steps(
    OperatorTransport& client, OperatorInterface& interface, const TeleopInput& world,
    const TeleopOptions& teleop, const SiteScene& scene, const OperatorSiteOptions& options,
    const SimulatedNetwork& network, const Observer& observer, const SiteRuntime& runtime);

}  // namespace pcavr
