// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/link.hpp"

#include <algorithm>
#include <limits>

#include "pcavr/core/check.hpp"

namespace pcavr {

Link::Link(const Options& options, const Random& random)
    : options_(options), random_(random), last_arrival_(-std::numeric_limits<double>::infinity()) {
  PCAVR_REQUIRE(options.delay >= 0.0, options.delay);
  PCAVR_REQUIRE(options.jitter >= 0.0, options.jitter);
  PCAVR_REQUIRE(options.loss >= 0.0 && options.loss <= 1.0, options.loss);
}

std::optional<double> Link::arrival(double t) {
  // Both are drawn for every message, so that a loss does not shift the random sequence.
  const bool is_lost = random_.uniform() < options_.loss;
  const double jitter = options_.jitter * random_.normal();
  if (is_lost) return std::nullopt;
  last_arrival_ = std::max(last_arrival_, t + std::max(options_.delay + jitter, 0.0));
  return last_arrival_;
}

}  // namespace pcavr
