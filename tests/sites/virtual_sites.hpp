// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/teleoperation/link/site_transport.hpp"

#include "teleoperation/sites/site_steps.hpp"

namespace pcavr {

/// Messages that one site has sent and the other has not received yet. The delay is the operator's
/// site's.
struct Wire {
  std::deque<std::vector<std::uint8_t>> to_robot;
  std::deque<std::vector<std::uint8_t>> to_operator;
  std::string peer = "operator";  ///< another one for each connection
};

inline std::optional<std::vector<std::uint8_t>> take_first(
    std::deque<std::vector<std::uint8_t>>& queue) {
  if (queue.empty()) return std::nullopt;
  std::vector<std::uint8_t> bytes = std::move(queue.front());
  queue.pop_front();
  return bytes;
}

class WireServer final : public RobotTransport {
 public:
  explicit WireServer(Wire& wire) : wire_(wire) {}
  void wait(double) override {}
  [[nodiscard]] std::optional<LinkPacket> receive() override {
    std::optional<std::vector<std::uint8_t>> bytes = take_first(wire_.to_robot);
    if (!bytes) return std::nullopt;
    return LinkPacket{wire_.peer, "", std::move(*bytes)};
  }
  bool send(const std::string&, std::span<const std::uint8_t> bytes) override {
    wire_.to_operator.emplace_back(bytes.begin(), bytes.end());
    return true;
  }
  [[nodiscard]] bool is_authorized(const std::string&) const override { return true; }
  [[nodiscard]] std::vector<std::string> take_notices() override { return {}; }

 private:
  Wire& wire_;
};

class WireClient final : public OperatorTransport {
 public:
  /// The site waits for what is under way at its end: virtual time goes on.
  WireClient(Wire& wire, double& t) : wire_(wire), t_(t) {}
  void wait(double timeout) override { t_ += timeout; }
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive() override {
    return take_first(wire_.to_operator);
  }
  bool send(std::span<const std::uint8_t> bytes) override {
    wire_.to_robot.emplace_back(bytes.begin(), bytes.end());
    return true;
  }
  void close(double) override {}
  [[nodiscard]] State state() override { return State::connected; }

 private:
  Wire& wire_;
  double& t_;  ///< [s]
};

/// A site's loop with its own clock, in true time.
template <typename Report>
struct SiteProcess {
  std::unique_ptr<SiteSteps<Report>> steps = {};
  double rate = 1.0;  ///< of its clock
  double next = 0.0;  ///< [s] true time

  static constexpr double kMinStep = 1e-7;  // [s] between two events: rounding of its clock

  void step(double t) {
    steps->step();
    next = t + std::max(steps->until_due() / rate, kMinStep);
  }
};

/// Runs both loops in true time `t` until `is_over`.
template <typename IsOver>
void run_in_virtual_time(SiteProcess<RobotSiteReport>& robot,
                         SiteProcess<OperatorSiteReport>& person, const Wire& wire, double& t,
                         IsOver is_over) {
  while (!is_over()) {
    t = std::max(t, std::min(robot.next, person.next));
    if (t >= person.next || !wire.to_operator.empty()) person.step(t);
    if (t >= robot.next || !wire.to_robot.empty()) robot.step(t);
  }
}

}  // namespace pcavr
