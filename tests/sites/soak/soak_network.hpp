// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"

#include "sites/soak/soak_checker.hpp"

namespace pcavr {

/// The network between two sites in virtual time, with faults. It stands for ZeroMQ with CurveZMQ:
/// bytes that a third party changed reach a site only if they are no message at all, because the
/// encryption is authenticated. Repetitions do reach it, which is more than CurveZMQ permits.
class SoakNetwork {
 public:
  enum Direction : std::size_t { to_robot, to_operator };
  static constexpr std::array<Direction, 2> kDirections{to_robot, to_operator};
  static constexpr const char* kOperatorKey = "operator-key";
  static constexpr const char* kIntruderKey = "intruder-key";  ///< was revoked

  SoakNetwork(const LinkConditions::Options& forward, const LinkConditions::Options& backward,
              const Random& random, SoakChecker& checker)
      : random_(random.fork(3)),
        conditions_{LinkConditions(forward, random.fork(1)),
                    LinkConditions(backward, random.fork(2))},
        checker_(checker) {}

  double now = 0.0;  ///< [s] true time

  // Functions of the sites' transports.
  void send(Direction direction, std::string peer, std::string key,
            std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<LinkPacket> receive(Direction direction);
  [[nodiscard]] bool has_arrived(Direction direction) const { return !inbox_[direction].empty(); }
  [[nodiscard]] const std::string& operator_peer() const { return peer_; }
  [[nodiscard]] bool is_authorized(const std::string& key) const {
    return authorized_.contains(key);
  }
  void set_authorized(const std::string& key, bool is_authorized);

  /// Time of the next arrival; nothing: none.
  [[nodiscard]] std::optional<double> next_arrival() const;
  void deliver();

  // Faults; times are those of their ends [s].
  void drop_until(Direction direction, double t) { drop_until_[direction] = t; }
  void stall_until(Direction direction, double t) { stall_until_[direction] = t; }
  void corrupt_until(double t) { corrupt_until_ = t; }
  /// Sends one of the messages of the last seconds again.
  void replay_one();
  /// A new connection of the operator's site: what was under way is lost.
  void reconnect();
  /// The receiving process was started or killed.
  void set_running(Direction direction, bool is_running);
  /// Messages of a second operator whose key was revoked while it was connected.
  void send_as_intruder();

 private:
  struct Packet {
    LinkPacket content;
    double sent = 0.0;
    bool is_genuine = true;
  };
  void corrupt(Packet& packet);
  void remember(Direction direction, const Packet& packet);

  Random random_;
  std::array<LinkConditions, 2> conditions_;
  SoakChecker& checker_;
  std::array<DelayedMessages<Packet>, 2> flying_;
  std::array<std::deque<LinkPacket>, 2> inbox_;
  std::array<std::deque<Packet>, 2> recent_;
  std::array<double, 2> drop_until_{-1.0, -1.0};
  std::array<double, 2> stall_until_{-1.0, -1.0};
  std::array<bool, 2> is_running_{true, true};
  double corrupt_until_ = -1.0;
  std::string peer_ = "operator-1";
  std::uint32_t connections_ = 1;
  std::uint32_t intruder_sequence_ = 0;
  std::set<std::string> authorized_;
};

class SoakServer final : public RobotTransport {
 public:
  explicit SoakServer(SoakNetwork& network) : network_(network) {}
  void wait(double) override {}
  [[nodiscard]] std::optional<LinkPacket> receive() override {
    return network_.receive(SoakNetwork::to_robot);
  }
  bool send(const std::string& peer, std::span<const std::uint8_t> bytes) override {
    network_.send(SoakNetwork::to_operator, peer, {}, bytes);
    return true;
  }
  [[nodiscard]] bool is_authorized(const std::string& key) const override {
    return network_.is_authorized(key);
  }
  [[nodiscard]] std::vector<std::string> take_notices() override { return {}; }

 private:
  SoakNetwork& network_;
};

class SoakClient final : public OperatorTransport {
 public:
  explicit SoakClient(SoakNetwork& network) : network_(network) {}
  void wait(double) override {}
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive() override {
    std::optional<LinkPacket> packet = network_.receive(SoakNetwork::to_operator);
    if (!packet) return std::nullopt;
    return std::move(packet->bytes);
  }
  bool send(std::span<const std::uint8_t> bytes) override {
    network_.send(SoakNetwork::to_robot, network_.operator_peer(), SoakNetwork::kOperatorKey,
                  bytes);
    return true;
  }
  void close(double) override {}
  [[nodiscard]] State state() override {
    return network_.is_authorized(SoakNetwork::kOperatorKey) ? State::connected : State::rejected;
  }

 private:
  SoakNetwork& network_;
};

}  // namespace pcavr
