// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pcavr {

/// Interfaces that the sites' main loops need of a network: LinkServer and LinkClient, or a
/// simulated network in virtual time. Nothing here blocks but wait(). One thread at a time.

/// A message, and who sent it.
struct LinkPacket {
  std::string peer = {};  ///< identity of the connection, for the answer
  std::string key = {};   ///< the sender's public key (Z85); empty without keys
  std::vector<std::uint8_t> bytes = {};
};

class RobotTransport {
 public:
  virtual ~RobotTransport() = default;

  /// Waits until a message is there, at most `timeout` [s].
  virtual void wait(double timeout) = 0;
  [[nodiscard]] virtual std::optional<LinkPacket> receive() = 0;
  /// False if it was dropped.
  virtual bool send(const std::string& peer, std::span<const std::uint8_t> bytes) = 0;
  /// Whether the key's file was in the folder a tenth of a second ago; always without keys.
  [[nodiscard]] virtual bool is_authorized(const std::string& key) const = 0;
  /// Lines for the operator of this program: connections that were rejected, since the last call.
  [[nodiscard]] virtual std::vector<std::string> take_notices() = 0;

 protected:
  RobotTransport() = default;
  RobotTransport(RobotTransport&&) = default;
  RobotTransport& operator=(RobotTransport&&) = default;
};

class OperatorTransport {
 public:
  virtual ~OperatorTransport() = default;

  /// Waits until a message is there, at most `timeout` [s].
  virtual void wait(double timeout) = 0;
  [[nodiscard]] virtual std::optional<std::vector<std::uint8_t>> receive() = 0;
  /// False if it was dropped.
  virtual bool send(std::span<const std::uint8_t> bytes) = 0;
  /// Ends the connection once what was sent has left this machine, at most `timeout` [s] after the
  /// transport's destruction begins.
  virtual void close(double timeout) = 0;

  enum class State { connecting, connected, rejected, no_handshake };
  /// `rejected`: the robot's site does not accept this key. `no_handshake`: it was reached, but
  /// ended the handshake: its key is another one, or one side has no keys.
  [[nodiscard]] virtual State state() = 0;

 protected:
  OperatorTransport() = default;
  OperatorTransport(OperatorTransport&&) = default;
  OperatorTransport& operator=(OperatorTransport&&) = default;
};

}  // namespace pcavr
