// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/core/random.hpp"

namespace pcavr {

/// One direction of the network in virtual time: delay, jitter and packet loss. In-order delivery:
/// a delayed message delays those after it (head-of-line blocking).
class Link {
 public:
  struct Options {
    double delay = 0.0;   ///< [s], >= 0
    double jitter = 0.0;  ///< standard deviation of the delay [s], >= 0
    double loss = 0.0;    ///< packet loss rate, 0 to 1
  };

  /// Throws ContractError if an option is out of range.
  Link(const Options& options, const Random& random);

  /// Arrival time of a message sent at `t` [s]; empty if it is lost. Call in order of time.
  [[nodiscard]] std::optional<double> arrival(double t);

 private:
  Options options_;
  Random random_;
  double last_arrival_;
};

}  // namespace pcavr
