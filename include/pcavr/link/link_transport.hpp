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

#include "pcavr/core/expected.hpp"
#include "pcavr/link/link_keys.hpp"

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

/// A message, and who sent it.
struct LinkPacket {
  std::string peer = {};  ///< identity of the connection, for the answer
  std::string key = {};   ///< the sender's public key (Z85); empty without keys
  std::vector<std::uint8_t> bytes = {};
};

/// The robot's site, which accepts connections.
class LinkServer {
 public:
  /// An Error if the port is in use, or the address is not loopback and there are no keys.
  [[nodiscard]] static Expected<LinkServer> open(const LinkServerOptions& options);
  LinkServer(LinkServer&&) noexcept;
  LinkServer& operator=(LinkServer&&) noexcept;
  ~LinkServer();

  [[nodiscard]] std::uint16_t port() const;
  /// Waits until a message is there, at most `timeout` [s].
  void wait(double timeout);
  [[nodiscard]] std::optional<LinkPacket> receive();
  /// False if it was dropped.
  bool send(const std::string& peer, std::span<const std::uint8_t> bytes);
  /// Whether the key's file is still in the folder; always without keys.
  [[nodiscard]] bool is_authorized(const std::string& key) const;
  /// Lines for the operator of this program: connections that were rejected, since the last call.
  [[nodiscard]] std::vector<std::string> take_notices();

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
class LinkClient {
 public:
  /// An Error if the address can't be used, or is not loopback and there are no keys.
  [[nodiscard]] static Expected<LinkClient> open(const LinkClientOptions& options);
  LinkClient(LinkClient&&) noexcept;
  LinkClient& operator=(LinkClient&&) noexcept;
  ~LinkClient();

  void wait(double timeout);
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive();
  bool send(std::span<const std::uint8_t> bytes);
  /// Ends the connection once what was sent has left this machine, at most `timeout` [s] after the
  /// client's destruction begins.
  void close(double timeout);

  enum class State { connecting, connected, rejected, no_handshake };
  /// `rejected`: the robot's site does not accept this key. `no_handshake`: it was reached, but
  /// ended the handshake: its key is another one, or one side has no keys.
  [[nodiscard]] State state();

 private:
  struct Impl;
  explicit LinkClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace pcavr
