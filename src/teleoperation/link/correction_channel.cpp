// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/correction_channel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

// RFC 6298, with limits for a link whose messages are small and urgent [s].
constexpr double kInitialTimeout = 0.5;
constexpr double kMinTimeout = 0.02;
constexpr double kMaxTimeout = 2.0;
constexpr int kMaxBackoffDoublings = 3;
// Transmissions before the timeout doubles: on a link of losses in bursts, rather than of
// congestion, a doubled timeout only delays all later corrections, which wait for this one.
constexpr int kPromptTransmissions = 4;
// A missing correction is sent again with the next new one, this much [s] after it was sent last:
// longer than a burst of losses, shorter than a round trip.
constexpr double kRepeatInterval = 0.1;
// A message counts as lost if one sent this much later has arrived [s]: a link's reordering.
constexpr double kReorderMargin = 0.03;

}  // namespace

CorrectionSender::CorrectionSender()
    : newest_acknowledged_sent_(-std::numeric_limits<double>::infinity()) {}

std::uint32_t CorrectionSender::push(LinkCorrection correction) {
  PCAVR_REQUIRE(!is_full(), pending_.size());
  Pending pending;
  pending.correction = std::move(correction);
  pending.correction.number = ++last_number_;
  pending_.push_back(std::move(pending));
  return last_number_;
}

double CorrectionSender::timeout() const {
  if (!has_delay_) return kInitialTimeout;
  return std::clamp(mean_delay_ + 4.0 * delay_variation_, kMinTimeout, kMaxTimeout);
}

std::vector<LinkCorrection> CorrectionSender::take_due(double now) {
  std::vector<LinkCorrection> due;
  const bool has_new = !pending_.empty() && pending_.back().transmissions == 0;
  for (Pending& pending : pending_) {
    if (pending.transmissions > 0) {
      const int doublings =
          std::clamp(pending.transmissions - kPromptTransmissions, 0, kMaxBackoffDoublings);
      const double timeout_now = std::min(std::ldexp(timeout(), doublings), kMaxTimeout);
      const bool is_late = now - pending.sent > timeout_now;
      const bool is_overtaken = newest_acknowledged_sent_ > pending.sent + kReorderMargin;
      const bool is_with_new = has_new && now - pending.sent > kRepeatInterval;
      if (!is_late && !is_overtaken && !is_with_new) continue;
      ++repetitions_;
    }
    pending.sent = now;
    ++pending.transmissions;
    due.push_back(pending.correction);
  }
  return due;
}

void CorrectionSender::note_acknowledged(const Pending& pending, double now) {
  newest_acknowledged_sent_ = std::max(newest_acknowledged_sent_, pending.sent);
  // Karn's algorithm: which transmission of a repeated message arrived is not known.
  if (pending.transmissions != 1) return;
  const double delay = now - pending.sent;
  const double variation = std::abs(delay - mean_delay_);
  delay_variation_ = has_delay_ ? 0.75 * delay_variation_ + 0.25 * variation : 0.5 * delay;
  mean_delay_ = has_delay_ ? 0.875 * mean_delay_ + 0.125 * delay : delay;
  has_delay_ = true;
}

void CorrectionSender::acknowledge(const LinkAcknowledgement& acknowledged, double now) {
  if (acknowledged.up_to > last_number_) return;
  const auto has_arrived = [&](const Pending& pending) {
    const std::uint32_t number = pending.correction.number;
    if (pending.transmissions == 0) return false;
    if (number <= acknowledged.up_to) return true;
    const std::uint32_t bit = number - acknowledged.up_to - 2;
    return number >= acknowledged.up_to + 2 && bit < 32 && (acknowledged.later >> bit & 1U) != 0;
  };
  for (const Pending& pending : pending_) {
    if (has_arrived(pending)) note_acknowledged(pending, now);
  }
  std::erase_if(pending_, has_arrived);
}

bool CorrectionReceiver::accept(LinkCorrection correction) {
  const std::uint32_t number = correction.number;
  if (number < next_ || number - next_ > kMaxAhead) return false;
  if (!received_.try_emplace(number, std::move(correction)).second) return false;
  while (received_.contains(next_)) ++next_;
  return true;
}

std::vector<LinkCorrection> CorrectionReceiver::take(double t) {
  std::vector<LinkCorrection> ready;
  while (taken_ + 1 < next_) {
    const auto found = received_.find(taken_ + 1);
    if (found->second.due > t) break;
    ++taken_;
    ready.push_back(std::move(found->second));
    received_.erase(found);
  }
  std::stable_sort(ready.begin(), ready.end(),
                   [](const LinkCorrection& a, const LinkCorrection& b) { return a.t < b.t; });
  return ready;
}

LinkAcknowledgement CorrectionReceiver::acknowledgement() const {
  LinkAcknowledgement result{next_ - 1, 0};
  for (const auto& [number, correction] : received_) {
    if (number < next_ + 1 || number - next_ - 1 >= 32) continue;
    result.later |= 1U << (number - next_ - 1);
  }
  return result;
}

}  // namespace pcavr
