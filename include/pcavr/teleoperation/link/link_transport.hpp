// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/link/link_keys.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"

namespace pcavr {

/// Messages over TCP by ZeroMQ, encrypted and mutually authenticated by CurveZMQ [RFC 26]. Nothing
/// here blocks: what a slow peer does not take is dropped, because every message but the
/// corrections is superseded by the next one, and those are sent again. One thread at a time.

/// Whether the address is this machine's own: "localhost", 127.0.0.0/8, "::1".
[[nodiscard]] bool is_loopback(const std::string& host);

struct LinkServerOptions {
  std::string host = "127.0.0.1";  ///< address or interface to listen on
  std::uint16_t port = 0;          ///< 0: any free one
  /// Without keys only on a loopback address, and then everything on it is accepted.
  std::optional<LinkKeys> keys = {};
  std::filesystem::path authorized = {};  ///< folder of the operators' .pub files, with keys
};

/// The robot's site, which accepts connections.
class LinkServer final : public RobotTransport {
 public:
  /// An Error if the port is in use, or the address is not loopback and there are no keys.
  [[nodiscard]] static Expected<LinkServer> open(const LinkServerOptions& options);
  LinkServer(LinkServer&&) noexcept;
  LinkServer& operator=(LinkServer&&) noexcept;
  ~LinkServer() override;

  [[nodiscard]] std::uint16_t port() const;
  void wait(double timeout) override;
  [[nodiscard]] std::optional<LinkPacket> receive() override;
  bool send(const std::string& peer, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] bool is_authorized(const std::string& key) const override;
  [[nodiscard]] std::vector<std::string> take_notices() override;

 private:
  struct Impl;
  explicit LinkServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct LinkClientOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
  std::optional<LinkKeys> keys = {};
  std::string robot_key = {};  ///< public key of the robot's site (Z85), with keys
};

/// The operator's site, which connects, and reconnects after an interruption.
class LinkClient final : public OperatorTransport {
 public:
  /// An Error if the address can't be used, or is not loopback and there are no keys.
  [[nodiscard]] static Expected<LinkClient> open(const LinkClientOptions& options);
  LinkClient(LinkClient&&) noexcept;
  LinkClient& operator=(LinkClient&&) noexcept;
  ~LinkClient() override;

  void wait(double timeout) override;
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive() override;
  bool send(std::span<const std::uint8_t> bytes) override;
  void close(double timeout) override;
  [[nodiscard]] State state() override;

 private:
  struct Impl;
  explicit LinkClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace pcavr
