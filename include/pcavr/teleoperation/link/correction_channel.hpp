// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

/// The sending side of the reliable channel of one session: each correction is sent again until it
/// is acknowledged. Resent after the timeout of RFC 6298, or earlier once a later message has been
/// acknowledged (RACK [RFC 8985]). Not thread-safe.
class CorrectionSender {
 public:
  /// More unacknowledged corrections than this: the link is as good as lost.
  static constexpr std::size_t kMaxPending = 1024;

  CorrectionSender();
  /// Queues a correction, whose number it replaces by the one it returns. Throws ContractError if
  /// full.
  std::uint32_t push(LinkCorrection correction);
  /// Corrections to be sent at `now` [s], first transmissions and repetitions, in order of their
  /// numbers.
  [[nodiscard]] std::vector<LinkCorrection> take_due(double now);
  /// Numbers that were never sent are ignored.
  void acknowledge(const LinkAcknowledgement& acknowledged, double now);

  [[nodiscard]] std::size_t pending() const { return pending_.size(); }
  [[nodiscard]] bool is_full() const { return pending_.size() >= kMaxPending; }
  [[nodiscard]] std::uint32_t last_number() const { return last_number_; }
  [[nodiscard]] std::uint64_t repetitions() const { return repetitions_; }
  [[nodiscard]] double timeout() const;  ///< [s] after which a message is sent again

 private:
  struct Pending {
    LinkCorrection correction;
    double sent = 0.0;  ///< [s] the last time
    int transmissions = 0;
  };
  void note_acknowledged(const Pending& pending, double now);

  std::deque<Pending> pending_;
  std::uint32_t last_number_ = 0;
  double newest_acknowledged_sent_;  ///< [s] when the newest acknowledged message was sent
  double mean_delay_ = 0.0;          ///< [s] SRTT of RFC 6298
  double delay_variation_ = 0.0;     ///< [s] RTTVAR
  bool has_delay_ = false;
  std::uint64_t repetitions_ = 0;
};

/// The receiving side: every correction exactly once, in order. Later ones wait for a missing one,
/// because each states only what has changed since the ones before it. Not thread-safe.
class CorrectionReceiver {
 public:
  /// Numbers further ahead than this are rejected: memory is bounded.
  static constexpr std::uint32_t kMaxAhead = CorrectionSender::kMaxPending;

  /// False for a repetition, and beyond kMaxAhead.
  bool accept(LinkCorrection correction);
  /// Corrections that have become complete and are due before `t` [s], in the order of the time
  /// they speak of; each once.
  [[nodiscard]] std::vector<LinkCorrection> take(double t);
  [[nodiscard]] LinkAcknowledgement acknowledgement() const;

 private:
  std::uint32_t next_ = 1;   ///< first number that is missing
  std::uint32_t taken_ = 0;  ///< last number that was taken
  std::map<std::uint32_t, LinkCorrection> received_;
};

}  // namespace pcavr
