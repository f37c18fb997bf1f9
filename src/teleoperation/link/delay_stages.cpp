// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/delay_stages.hpp"

#include <cstddef>

namespace pcavr {
namespace {

constexpr std::size_t kMaxSent = 10'000;  // ten seconds of commands: longer than any session waits

}  // namespace

void DelayMeans::add(const DelayStamps& stamps) {
  const std::array<double, 6> times{stamps.sent,   stamps.received,  stamps.applied,
                                    stamps.sensed, stamps.sent_back, stamps.received_back};
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += times[i + 1] - times[i];
  ++count_;
}

std::array<DelayMeans::Stage, 5> DelayMeans::stages() const {
  constexpr std::array<std::string_view, 5> kNames{"sent to received", "received to applied",
                                                   "applied to sensed", "sensed to sent back",
                                                   "sent back to received"};
  std::array<Stage, 5> stages;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    stages[i] = {kNames[i], count_ > 0 ? sums_[i] / static_cast<double>(count_) : 0.0};
  }
  return stages;
}

void SentCommands::add(double t, double sent, std::optional<double> device_clock) {
  if (sent_.size() >= kMaxSent) sent_.pop_front();
  sent_.push_back({t, sent, device_clock});
}

std::optional<SentCommands::Sent> SentCommands::find(double t) {
  while (!sent_.empty() && sent_.front().t < t) sent_.pop_front();
  if (sent_.empty() || sent_.front().t != t) return std::nullopt;
  return sent_.front();
}

}  // namespace pcavr
