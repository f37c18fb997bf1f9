// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_conditions.hpp"

#include <algorithm>
#include <limits>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

LinkConditions::LinkConditions(const Options& options, const Random& random)
    : options_(options),
      random_(random),
      burst_random_(random.fork(101)),
      reorder_random_(random.fork(102)),
      duplicate_random_(random.fork(103)),
      free_at_(-std::numeric_limits<double>::infinity()),
      last_arrival_(-std::numeric_limits<double>::infinity()) {
  PCAVR_REQUIRE(options.delay >= 0.0, options.delay);
  PCAVR_REQUIRE(options.jitter >= 0.0, options.jitter);
  PCAVR_REQUIRE(options.loss >= 0.0 && options.loss <= 1.0, options.loss);
  PCAVR_REQUIRE(options.burst >= 0.0, options.burst);
  PCAVR_REQUIRE(options.reorder >= 0.0 && options.reorder <= 1.0, options.reorder);
  PCAVR_REQUIRE(options.reorder_delay >= 0.0, options.reorder_delay);
  PCAVR_REQUIRE(options.duplicate >= 0.0 && options.duplicate <= 1.0, options.duplicate);
  PCAVR_REQUIRE(options.rate_limit >= 0.0, options.rate_limit);
  PCAVR_REQUIRE(options.max_queue >= 0.0, options.max_queue);
}

bool LinkConditions::is_lost() {
  // Drawn for every message, so that a loss does not shift the random sequence.
  const bool is_lost_alone = random_.uniform() < options_.loss;
  if (options_.burst < 1.0 || options_.loss <= 0.0 || options_.loss >= 1.0) return is_lost_alone;
  // Every message is lost in the bad state. The mean length of that state is 1 / leave, its share
  // of the time enter / (enter + leave) = loss.
  const double leave = 1.0 / options_.burst;
  const double enter = leave * options_.loss / (1.0 - options_.loss);
  is_bad_ = burst_random_.uniform() < (is_bad_ ? 1.0 - leave : std::min(enter, 1.0));
  return is_bad_;
}

LinkConditions::Arrivals LinkConditions::arrivals(double t, std::size_t bytes) {
  const bool was_lost = is_lost();
  const double jitter = options_.jitter * random_.normal();
  const bool is_overtaken = reorder_random_.uniform() < options_.reorder;
  const bool is_doubled = duplicate_random_.uniform() < options_.duplicate;
  double sent = t;
  if (options_.rate_limit > 0.0) {
    // Lost ones have passed the bottleneck, too.
    sent = std::max(t, free_at_) + static_cast<double>(bytes) / options_.rate_limit;
    if (sent - t > options_.max_queue) return {};
    free_at_ = sent;
  }
  if (was_lost) return {};
  Arrivals arrivals;
  const double direct = sent + std::max(options_.delay + jitter, 0.0);
  if (is_overtaken) {
    arrivals.first = direct + options_.reorder_delay;
  } else {
    last_arrival_ = std::max(last_arrival_, direct);
    arrivals.first = last_arrival_;
  }
  if (is_doubled) arrivals.second = *arrivals.first + options_.reorder_delay;
  return arrivals;
}

}  // namespace pcavr
