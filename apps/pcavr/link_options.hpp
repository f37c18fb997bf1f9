// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"

#include "number_option.hpp"

namespace pcavr::app {

inline constexpr InputRange kBurst{"burst of losses", 0.0, 1e4, "messages",
                                   "ten seconds of commands at 1 kHz"};
inline constexpr InputRange kByteRate{"rate limit", 0.0, 1e10, "B/s",
                                      "faster than the fastest network card"};

/// --jitter, --loss, --burst, --reorder, --duplicate and --rate-limit, the same in both directions.
inline void add_link_conditions(CLI::App& command, LinkConditions::Options& forward,
                                LinkConditions::Options& backward) {
  const auto add = [&](const std::string& name, double LinkConditions::Options::*member,
                       const InputRange& range, const std::string& what) {
    command
        .add_option_function<double>(
            name,
            [&forward, &backward, member](double value) {
              forward.*member = value;
              backward.*member = value;
            },
            what)
        ->check(number_in(range));
  };
  add("--jitter", &LinkConditions::Options::jitter, ranges::kJitter,
      "Simulated network: standard deviation of both delays [s]");
  add("--loss", &LinkConditions::Options::loss, ranges::kShare,
      "Simulated network: fraction of the messages that it drops");
  add("--burst", &LinkConditions::Options::burst, kBurst,
      "Simulated network: mean number of messages that are lost in a row (Gilbert)");
  add("--reorder", &LinkConditions::Options::reorder, ranges::kShare,
      "Simulated network: fraction of the messages that are overtaken, by 20 ms");
  add("--duplicate", &LinkConditions::Options::duplicate, ranges::kShare,
      "Simulated network: fraction of the messages that arrive twice");
  add("--rate-limit", &LinkConditions::Options::rate_limit, kByteRate,
      "Simulated network: bytes per second of its bottleneck; 0: no limit");
}

}  // namespace pcavr::app
