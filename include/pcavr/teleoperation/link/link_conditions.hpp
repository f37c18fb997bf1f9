// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>

#include "pcavr/base/core/random.hpp"

namespace pcavr {

/// One direction of a network: what it does to the messages that are sent over it. It only computes
/// times, so that it serves virtual time (replay) and real time (DelayedMessages) alike.
/// Deterministic by its random numbers; not thread-safe.
class LinkConditions {
 public:
  struct Options {
    double delay = 0.0;   ///< [s], >= 0
    double jitter = 0.0;  ///< standard deviation of the delay [s], >= 0
    double loss = 0.0;    ///< packet loss rate, 0 to 1
    /// Mean length of a burst of losses [messages]; from 1 on, losses follow the two-state model of
    /// Gilbert [1960], with the rate `loss` as its mean; below 1 they are independent.
    double burst = 0.0;
    /// Share of the messages that are overtaken: they arrive `reorder_delay` later, and those sent
    /// after them don't wait. With 0, messages keep their order under jitter (head-of-line
    /// blocking).
    double reorder = 0.0;
    double reorder_delay = 0.020;  ///< [s]
    double duplicate = 0.0;        ///< share of the messages that arrive twice
    double rate_limit = 0.0;       ///< [bytes/s] of the bottleneck; 0: none
    /// [s] of waiting at the bottleneck beyond which messages are dropped (drop-tail queue)
    double max_queue = 0.5;
  };

  /// Throws ContractError if an option is out of range.
  LinkConditions(const Options& options, const Random& random);

  /// Arrival times of a message of `bytes` sent at `t` [s]: the first, and a duplicate's. Both are
  /// empty if it is lost. Call in order of time.
  struct Arrivals {
    std::optional<double> first = {};
    std::optional<double> second = {};
  };
  [[nodiscard]] Arrivals arrivals(double t, std::size_t bytes = 0);
  /// The first of them.
  [[nodiscard]] std::optional<double> arrival(double t, std::size_t bytes = 0) {
    return arrivals(t, bytes).first;
  }

 private:
  [[nodiscard]] bool is_lost();

  Options options_;
  Random random_;        ///< of jitter and independent losses
  Random burst_random_;  ///< each further condition has its own, so that none changes another
  Random reorder_random_;
  Random duplicate_random_;
  bool is_bad_ = false;   ///< state of the burst model
  double free_at_ = 0.0;  ///< [s] when the bottleneck is free
  double last_arrival_;
};

/// Messages under way: released when they have arrived, in the order of arrival. Memory is bounded:
/// beyond `max_messages` the oldest is dropped. Not thread-safe.
template <typename Message>
class DelayedMessages {
 public:
  explicit DelayedMessages(std::size_t max_messages = 65536) : max_messages_(max_messages) {}

  void push(double arrival, Message message) {
    if (waiting_.size() >= max_messages_) waiting_.erase(waiting_.begin());
    auto place = waiting_.end();
    while (place != waiting_.begin() && std::prev(place)->first > arrival) --place;
    waiting_.emplace(place, arrival, std::move(message));
  }
  /// The next one that has arrived by `now` [s].
  [[nodiscard]] std::optional<Message> pop(double now) {
    if (waiting_.empty() || waiting_.front().first > now) return std::nullopt;
    std::optional<Message> message(std::move(waiting_.front().second));
    waiting_.pop_front();
    return message;
  }
  /// [s] when the next one arrives.
  [[nodiscard]] std::optional<double> next_arrival() const {
    if (waiting_.empty()) return std::nullopt;
    return waiting_.front().first;
  }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  std::size_t max_messages_;
  std::deque<std::pair<double, Message>> waiting_;
};

}  // namespace pcavr
