// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "pcavr/teleoperation/link/command_buffer.hpp"
#include "pcavr/teleoperation/link/correction_channel.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"

namespace pcavr {

/// State of one connected operator's site: what it has sent, and is to receive.
struct OperatorSession {
  std::string peer;
  std::string key;
  std::uint32_t id = 0;
  double last_received = 0.0;
  std::uint32_t newest = 0;       ///< sequence number of its messages so far
  std::uint32_t newest_stop = 0;  ///< sequence number of the newest hold, stop or release
  CorrectionSender corrections;
  CommandBuffer commands;
};

/// The session of the one operator whom the robot's site accepts, and what remains of the last one.
class OperatorSessions {
 public:
  [[nodiscard]] OperatorSession* current() { return session_ ? &*session_ : nullptr; }
  [[nodiscard]] const OperatorSession* current() const { return session_ ? &*session_ : nullptr; }

  void begin(OperatorSession session) { session_ = std::move(session); }
  void end() {
    ended_peer_ = session_->peer;
    ended_newest_ = session_->newest;
    session_.reset();
  }

  [[nodiscard]] bool has_sent(const LinkPacket& packet, const LinkHeader& header) const {
    return session_ && session_->peer == packet.peer && session_->id == header.session;
  }
  /// Only newer messages show that the operator's site is there: not repeated ones, nor those that
  /// waited while this site did not run, and so count from when it ran last, `last_step`.
  void note_received(const LinkHeader& header, double last_step) {
    if (header.sequence <= session_->newest) return;
    session_->newest = header.sequence;
    session_->last_received = std::max(session_->last_received, last_step);
  }
  /// A connection's hello that is not newer than what it sent in its last session.
  [[nodiscard]] bool is_old(const LinkPacket& packet, const LinkHeader& header) const {
    if (session_) return session_->peer == packet.peer && header.sequence <= session_->newest;
    return ended_peer_ == packet.peer && header.sequence <= ended_newest_;
  }
  /// Each connection is another operator, also with the same key: two consoles would take the
  /// session from each other. One that has lost its connection waits until that session has ended.
  [[nodiscard]] bool is_of_another(const LinkPacket& packet) const {
    return session_ && session_->peer != packet.peer;
  }
  [[nodiscard]] bool has_same_key(const LinkPacket& packet) const {
    return session_ && !packet.key.empty() && session_->key == packet.key;
  }

 private:
  std::optional<OperatorSession> session_;
  std::string ended_peer_;          ///< of the last session that has ended
  std::uint32_t ended_newest_ = 0;  ///< sequence number of its messages
};

}  // namespace pcavr
