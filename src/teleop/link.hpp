// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/core/random.hpp"

namespace pcavr {

/// One direction of the network in virtual time: a delay, its jitter, and loss. Messages keep their
/// order: one that was held up holds up those behind it.
class Link {
 public:
  struct Options {
    double delay = 0.0;   ///< [s], >= 0
    double jitter = 0.0;  ///< standard deviation of the delay [s], >= 0
    double loss = 0.0;    ///< share of messages that never arrive, 0 to 1
  };

  /// Throws ContractError for an option out of its range.
  Link(const Options& options, const Random& random);

  /// When a message sent at `t` [s] arrives; nothing where it is lost. Call in order of time.
  [[nodiscard]] std::optional<double> arrival(double t);

 private:
  Options options_;
  Random random_;
  double last_arrival_;
};

}  // namespace pcavr
